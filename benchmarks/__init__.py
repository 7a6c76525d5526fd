"""The benchmarks: one command, ``python -m benchmarks``, makes one Markdown table."""
