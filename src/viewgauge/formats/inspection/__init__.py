"""The inspection file: its text, its sections, and the objects that they stand for."""
