# Three commands set everything up by themselves: `make view`, `make demo` and `make test`; so does `make embed`.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALL ?= $(BIN)/python -m pip install --quiet
MODEL := models/eight_body.toml
EXAMPLES := $(notdir $(basename $(wildcard examples/*.py)))
NOTEBOOKS := $(notdir $(basename $(wildcard docs/notebooks/*.md)))

.PHONY: demo view test slow embed call-times examples lint generated bench growth extremes gimbal-lock tradeoff scenes viewer cost-reports closed-forms validation truth gallery docs notebooks clean

# Simulate an arm that turns about its column, and show its motion in the browser.
view: $(VENV)/.kanegen
	mkdir -p build
	$(BIN)/kanegen view examples/arm.urdf --duration 10 --y column_joint=4 \
		--path tool -o build/arm.html --open

demo: $(VENV)/.kanegen
	$(BIN)/kanegen info $(MODEL)
	$(BIN)/kanegen generate $(MODEL) --output-dir build/eight_body --force
	$(BIN)/kanegen check $(MODEL)

test: lint
	$(BIN)/python -m pytest -n auto --dist worksteal

# Run the tests that take too long for every change.
slow: $(VENV)/.tests
	$(BIN)/python -m pytest -n auto --dist worksteal -m "slow and not embed"

# Install what uses generated code in other programs, and test the code in it: `make embed-rust` for one program,
# `make embed` for all.
embed: $(VENV)/.tests
	$(BIN)/python -m tests.embedding

embed-%: $(VENV)/.tests
	$(BIN)/python -m tests.embedding $*

# Run the examples of control loops and rewrite their pictures in docs/examples.
examples: $(VENV)/.tests
	$(INSTALL) --editable .[jax]
	for name in $(EXAMPLES); do SOURCE_DATE_EPOCH=0 $(BIN)/python examples/$$name.py docs/examples/$$name.svg || exit; done

# Time calls through each of these programs beside the C alone, and rewrite docs/embedding/call-times.md.
call-times: $(VENV)/.tests
	$(BIN)/python -m benchmarks.embedding

lint: $(VENV)/.tests
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

# Rewrite generated/ from models/ after a change that is meant to alter the C.
generated: $(VENV)/.tests
	$(BIN)/python -m pytest tests/c/test_generated.py --update-generated

# Time kanegen and its peers and rewrite docs/benchmarks.md and the speeds in the README; the first time Pinocchio takes minutes to
# compile. `make bench MODELS="panda hyq"` times some models and writes into build/benchmarks.
bench: $(VENV)/.bench
	$(BIN)/python -m benchmarks $(MODELS)

# Compare closed forms with those of SymPy's KanesMethod and of textbooks; rewrites docs/closed-forms.md in a minute.
closed-forms: $(VENV)/.tests
	$(BIN)/python -m benchmarks.closed_forms

# Generate, compile and run trees of 1 to 256 bodies and rewrite docs/growth.md; takes about an hour.
growth: $(VENV)/.bench
	$(BIN)/python -m benchmarks.growth

# Try the C where arithmetic is hardest and rewrite docs/extremes.md; takes about half an hour.
extremes: $(VENV)/.tests $(VENV)/.bench
	$(BIN)/python -m tests.battery

# Write the demonstration of gimbal lock, build/live/gimbal-lock.html, and its picture at the top of the README; needs
# Chromium.
gimbal-lock: $(VENV)/.tests
	$(BIN)/python -m benchmarks.gimbal_lock

# Study speed against accuracy of three models and rewrite docs/tradeoff; takes about three quarters of an hour.
tradeoff: $(VENV)/.bench
	$(BIN)/python -m benchmarks.tradeoff

# Measure what five scenes save against the general programs of their trees; rewrites docs/scenes.md in a few minutes.
scenes: $(VENV)/.bench
	$(BIN)/python -m benchmarks.scenes

# Build the script of pages with pictures from viewer/; needs node and npm.
viewer:
	cd viewer && npm ci --no-audit --no-fund && node build.mjs

# Compare the operations of every model with those of the general program of its tree; rewrites docs/models in a
# minute.
cost-reports: $(VENV)/.tests
	$(BIN)/python -m benchmarks.cost_reports

# Compute cases that others have published and rewrite docs/validation.md; takes about two minutes.
validation: $(VENV)/.tests
	$(BIN)/python -m benchmarks.validation

# Compute the exact numbers of five trees again and rewrite docs/truth; takes some seconds.
truth: $(VENV)/.tests
	$(BIN)/python -m benchmarks.validation.truth

# Simulate every model and rewrite the moving pictures of docs/gallery; takes a minute.
gallery: $(VENV)/.docs
	PYTHONPATH=docs $(BIN)/python -m website.gallery

# Make the site of the pages in docs/ in build/site. Notebooks run, and motions are simulated, the first time and when
# their code changes; that takes two minutes.
docs: $(VENV)/.docs
	$(BIN)/python -m sphinx -c docs/website docs build/site --nitpicky --fail-on-warning --keep-going --quiet
	@echo "Open build/site/index.html"

# Run the notebooks in docs/notebooks and write them with their results into build/ipynb, for Jupyter.
notebooks: $(VENV)/.docs
	mkdir -p build/ipynb
	for page in $(NOTEBOOKS); do $(BIN)/mystnb-to-jupyter --overwrite docs/notebooks/$$page.md build/ipynb/$$page.ipynb || exit; done
	cd build/ipynb && ../../$(BIN)/jupyter-execute --inplace $(NOTEBOOKS:%=%.ipynb)

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.kanegen: $(VENV)/bin/python pyproject.toml
	$(INSTALL) --editable .
	touch $@

$(VENV)/.tests: $(VENV)/bin/python pyproject.toml
	$(INSTALL) --editable ".[test]"
	touch $@ $(VENV)/.kanegen

$(VENV)/.docs: $(VENV)/bin/python pyproject.toml
	$(INSTALL) --editable ".[docs]"
	touch $@ $(VENV)/.kanegen

$(VENV)/.bench: $(VENV)/bin/python pyproject.toml
	$(INSTALL) --editable ".[bench]"
	touch $@ $(VENV)/.kanegen
