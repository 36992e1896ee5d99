"""From text to forms: tokens, brackets, the grammar of a form, and the element that it describes."""
