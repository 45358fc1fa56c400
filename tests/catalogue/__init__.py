"""The list of what can be composed: one line each, and every property test runs over all of them.

To add something, add a line to the list of its subject: a name, what builds its components afresh, and what a run
of it conserves: 'energy' if no load, motor or damper does work, and columns of the ledger such as 'momentum_x',
'angular_z'. The balance of energy is checked for every entry, whatever it contains.
"""

from catalogue.beams import BEAMS
from catalogue.contact import CONTACT
from catalogue.entry import Components, Entry
from catalogue.flow import FLOW
from catalogue.fracture import FRACTURE
from catalogue.instances import INSTANCES
from catalogue.phase import PHASE
from catalogue.rigid import RIGID
from catalogue.solids import SOLIDS
from catalogue.thermal import THERMAL
from catalogue.thin_contacts import THIN_CONTACTS
from catalogue.viscous import VISCOUS

CATALOGUE = [
    *RIGID,
    *SOLIDS,
    *BEAMS,
    *CONTACT,
    *THIN_CONTACTS,
    *FLOW,
    *THERMAL,
    *PHASE,
    *VISCOUS,
    *FRACTURE,
    *INSTANCES,
]

__all__ = ["CATALOGUE", "Components", "Entry"]
