"""Speed against accuracy of three models, and certificates of two: what docs/tradeoff holds."""
