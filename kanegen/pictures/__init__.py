"""Pictures and HTML that notebooks show: plain data in, text out.

Here live the drawing of a tree as SVG, tables and folded parts of HTML, and the class `Picture`. Whatever
comes from a model is escaped, and nothing is a script. Which facts of a system, a report or a library are
shown is decided beside these classes, in modules such as `kanegen.model.system_html`; nothing here knows
them.
"""
