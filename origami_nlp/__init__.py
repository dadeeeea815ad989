"""origami_nlp: the stable states of an origami vertex, found and proved."""
