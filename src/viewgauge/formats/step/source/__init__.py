"""A STEP file before the CAD kernel sees it: unpacked, decoded, in a form that the kernel reads, and what it lacks."""
