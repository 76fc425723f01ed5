"""What a report shows of a recording and what was made of it, as plain numbers; drawn elsewhere."""

from strainwave.evidence.contacts import Contact
from strainwave.evidence.envelope import Envelope
from strainwave.evidence.flags import FlaggedRows, Stretch
from strainwave.evidence.gathering import Evidence, filter_as_identified, filter_with_evidence
from strainwave.evidence.lines import OrderLine
from strainwave.evidence.spectra import OrderMap, OrderSpectrum

__all__ = [
    "Contact",
    "Envelope",
    "Evidence",
    "FlaggedRows",
    "OrderLine",
    "OrderMap",
    "OrderSpectrum",
    "Stretch",
    "filter_as_identified",
    "filter_with_evidence",
]
