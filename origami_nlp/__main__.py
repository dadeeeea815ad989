"""``python -m origami_nlp``: the command line."""

from origami_nlp.cli import main

if __name__ == "__main__":
    main()
