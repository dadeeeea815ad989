"""Files that want to hurt: how all that is read is spoilt, and what each reader does with it."""
