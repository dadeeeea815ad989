"""The paper's claims, one module per section; `origami_nlp.symbolic.catalogue` puts them in order."""
