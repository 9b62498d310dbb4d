"""Components: declarations followed by named equations."""
