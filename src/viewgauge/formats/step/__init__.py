"""STEP files: geometry by the CAD kernel in a child process, PMI from the records of the text."""
