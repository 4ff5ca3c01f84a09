"""What all file formats share: reading text and YAML, units, problems with their line, atomic writing, locks."""
