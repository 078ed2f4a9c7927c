"""A command line, from its first import to its exit code: each program of the workbook is started here."""

import sys

import typer

from .processes import ending_once, one_sentence

UsageError = typer.BadParameter.__base__     # of every wrong option or command; typer may bring a click of its own


def start(program, does, arguments=None, hint=None):
    """Run a program: a Typer app, or a function whose parameters are its options.

    An option that it does not know ends in one sentence and exit code 2.  Ctrl-C ends in *interrupted* and 130.
    hint: (arguments) → what may have been meant, as the end of that sentence
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    with one_sentence(program), ending_once():
        try:
            code = app_of(does)(arguments, prog_name=program, standalone_mode=False)
        except UsageError as e:
            ending = hint(arguments) if hint else f": `{program} --help` names all that there is"
            print(f"{program}: {e.format_message().rstrip('.')}{ending}.", file=sys.stderr)
            code = 2
        sys.exit(code)


def app_of(does):
    """Return the Typer app of a program that may be a single function."""
    if isinstance(does, typer.Typer):
        return does
    app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    app.command()(does)
    return app
