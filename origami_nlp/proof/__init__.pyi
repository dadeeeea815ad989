from .singular import Isolation as Isolation, isolated as isolated
