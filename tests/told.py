"""Words of form finding: those of a refusal, or of the warning beside a form."""

import warnings

from fx_membrane import UnsettledFormWarning


def told(find, *args, **settings):
    """Return the form, None where it is refused, and the words of the refusal or the warnings."""
    with warnings.catch_warnings(record=True) as entries:
        warnings.simplefilter("always")
        try:
            form = find(*args, **settings)
        except (RuntimeError, ValueError) as refusal:
            return None, str(refusal)
    return form, " ".join(str(entry.message) for entry in entries if issubclass(entry.category, UnsettledFormWarning))
