"""The texts of a site: web/site.py FOLDER writes README.md, docs/ and the reference of all headers as HTML by pandoc,
with formulas as MathML, and copies what they link to. Links that lead to nothing end it with a line each."""
import os
import re
import shutil
import subprocess
import sys

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
HEAD = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #223; max-width: 60rem; margin: 0 auto; padding: 0 16px 60px; }}
nav {{ padding: 10px 0; border-bottom: 1px solid #dde; }} nav a {{ margin-right: 16px; }}
pre, code {{ font: 13.5px/1.45 ui-monospace, monospace; background: #f4f5f8; }}
pre {{ padding: 10px; overflow-x: auto; }}
table {{ border-collapse: collapse; display: block; overflow-x: auto; }}
td, th {{ border: 1px solid #dde; padding: 3px 9px; text-align: left; vertical-align: top; }}
img {{ max-width: 100%; }} a {{ color: #0057a8; }}
</style>
<nav>
<a href="{up}index.html">A wet screen</a><a href="{up}scenes.html">Scenes</a>
<a href="{up}readme.html">What Riddle is</a><a href="{up}docs/README.html">Pages</a>
<a href="{up}reference/index.html">Reference</a>
</nav>
"""


def target_of(link, folder, site):
    """Where a link of a page in folder leads in the site; None: to nothing there. What it needs is copied."""
    path, hash_, anchor = link.partition("#")
    if not path or "://" in path or path.startswith("mailto:"):
        return link
    source = os.path.normpath(os.path.join(folder, path))
    if source == "README.md":
        return os.path.relpath("readme.html", folder or ".") + hash_ + anchor
    if source.endswith(".md") and os.path.exists(os.path.join(root, source)):
        return path[:-3] + ".html" + hash_ + anchor
    if re.fullmatch(r"\w+\.h", source) and os.path.exists(os.path.join(root, source)):
        return os.path.relpath(f"reference/{source[:-2]}.html", folder or ".")
    if not os.path.isfile(os.path.join(root, source)):
        return None
    there = os.path.join(site, source)
    os.makedirs(os.path.dirname(there), exist_ok=True)
    shutil.copyfile(os.path.join(root, source), there)
    return link


def write_page(text, name, site, links=None):
    """Markdown -> site/name; links: how a link is rewritten (default: those between pages of the reference)."""
    up = "../" * name.count("/")
    title = re.search(r"^# (.*)$", text, re.M)
    html = subprocess.run(["pandoc", "-f", "gfm+tex_math_dollars", "-t", "html", "--mathml", "--no-highlight"],
                          input=text, capture_output=True, text=True, check=True).stdout
    rewrite = links or (lambda link: link.replace(".md", ".html"))

    def one(match):
        to = rewrite(match[2])
        return f'{match[1]}"{to}"' if to is not None else 'data-in-the-repository="yes"'
    html = re.sub(r'((?:href|src)=)"([^"]*)"', one, html)
    path = os.path.join(site, name)
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(HEAD.format(title=re.sub(r"[`*]", "", title[1]) if title else "Riddle", up=up) + html + "</html>\n")


def dead_links(site):
    """Links to files that are not there, and to anchors that a page lacks."""
    pages = {}
    for folder, _, files in os.walk(site):
        for name in files:
            if name.endswith(".html"):
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    pages[os.path.join(folder, name)] = file.read()
    anchors = {path: set(re.findall(r'\bid="([^"]*)"', text)) for path, text in pages.items()}
    for path, text in pages.items():
        for link in re.findall(r'(?:href|src)="([^"]+)"', text):
            to, _, anchor = link.partition("#")
            there = os.path.normpath(os.path.join(os.path.dirname(path), to)) if to else path
            if "://" in link:
                continue
            if not os.path.exists(there) or anchor and there in anchors and anchor not in anchors[there]:
                yield f"{os.path.relpath(path, site)}: {link}"


def main():
    site = sys.argv[1]
    made = os.path.join(site, "reference")
    subprocess.run([sys.executable, os.path.join(root, "scripts", "reference"), made], check=True,
                   stdout=subprocess.DEVNULL)
    for name in sorted(os.listdir(made)):
        if name.endswith(".md"):
            with open(os.path.join(made, name), encoding="utf-8") as file:
                write_page(file.read(), f"reference/{name[:-3]}.html", site)
            os.remove(os.path.join(made, name))
    sources = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "benchmarks/README.md"]
    sources += [f"docs/{name}" for name in sorted(os.listdir(os.path.join(root, "docs"))) if name.endswith(".md")]
    for source in sources:
        folder = os.path.dirname(source)
        with open(os.path.join(root, source), encoding="utf-8") as file:
            text = file.read()
        write_page(text, "readme.html" if source == "README.md" else source[:-3] + ".html", site,
                   lambda link, f=folder: target_of(link, f, site))
    dead = sorted(set(dead_links(site)))
    print("".join(f"leads to nothing: {line}\n" for line in dead), end="")
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main())
