"""Where and how long jobs run: chunks, this process or a cluster, child processes, progress, fingerprints."""
