"""What the workbench asks for: what-if answers while a knob turns, views, child jobs, files to download."""
