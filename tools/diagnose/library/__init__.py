"""What may be wrong: causes, sensors' faults and nuisances, one file a family.

The page `contributing/cause.md` of the documentation shows how to add a cause.
"""

from ....model.machines.roles import Roles
from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Ranges, Row, Shape, Size
from .extras import Extras
from .forms import Context

__all__ = ["Cause", "Context", "Extras", "Form", "Ranges", "Roles", "Row", "Sensor", "Shape", "Size"]
