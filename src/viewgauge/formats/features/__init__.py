"""Features of a part and proposed characteristics as text that goes into an inspection file."""
