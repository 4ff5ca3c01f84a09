"""The files of a plan, written and read back, and the answers of improve and specify."""
