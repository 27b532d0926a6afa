"""A tree of rigid bodies, the source language of kanegen: bodies, joints, points, force elements."""
