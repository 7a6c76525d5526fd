"""Runs as pages for the browser, which need no server: by viser, which is imported when the first one is written."""
