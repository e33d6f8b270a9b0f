"""x"""


def write(results, folder, figures):
    """x."""
    from collections import Counter

    return "\n".join(map(str, sorted(Counter((p.variant, v.verdict, v.refusal) for p, v in results).items())))
