"""The paper's claims, one module per section; `symbolic.catalogue` puts them in order."""
