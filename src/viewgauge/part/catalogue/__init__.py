"""The features of a B-rep with ids: planes, straight edges, holes, bosses, slots, and the characteristics on them."""

from .catalogue import Catalogue, catalogue_of
from .part_feature import PartFeature
from .proposals import Proposal, propose
from .stated import outcome_on_features

__all__ = ["Catalogue", "PartFeature", "Proposal", "catalogue_of", "outcome_on_features", "propose"]
