"""Tables viewpoint x characteristic: CSV, Parquet and Zarr."""
