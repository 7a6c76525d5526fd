"""The broad phase: bounding boxes, the trees over them, and the pairs of shapes whose boxes overlap."""
