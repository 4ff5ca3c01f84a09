"""The terminal: what is printed there, progress, findings, and the one line of a first run."""
