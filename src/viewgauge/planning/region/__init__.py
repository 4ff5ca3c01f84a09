"""The allowed region: where the camera may stand."""
