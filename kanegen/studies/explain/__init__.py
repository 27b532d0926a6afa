"""What a scene does not need, and what that saves: the specialised program beside the general one."""

from kanegen.studies.explain.exactness import Exactness, exactness
from kanegen.studies.explain.receipt import Receipt, Step, receipt

__all__ = ["Exactness", "Receipt", "Step", "exactness", "receipt"]
