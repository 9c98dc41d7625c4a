# Everyday commands. Needs python3 and make; the rest goes into .venv by itself.

PYTHON ?= python3
VENV ?= .venv
TEST_JOBS ?= 2
# Extra arguments, e.g. `make test ARGS="-k walk"` or `make demo ARGS="--help"`.
ARGS ?=

BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

EXTRAS := .[dev]
# Shows the output of a command only if the command fails.
QUIETLY = output=$$($(1) 2>&1) || { echo "$$output"; exit 1; }

.DEFAULT_GOAL := help
.PHONY: help setup demo test fast check format docs bench constraints clean

help: ## Show this list.
	@echo "Usage: make <target>"
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  %-12s %s\n", $$1, $$2 }' Makefile

setup: $(STAMP) ## Create the environment (every other target does so when needed).

demo: $(STAMP) ## Run the demonstration in a browser.
	@$(BIN)/atlas-drake demo $(ARGS)

test: $(STAMP) ## Run all tests.
	@$(BIN)/python -m pytest -n $(TEST_JOBS) --dist worksteal $(ARGS)

fast: $(STAMP) ## Run the fast tests (a minute on two cores).
	@$(BIN)/python -m pytest -n $(TEST_JOBS) --dist worksteal -m "not slow" $(ARGS)

check: $(STAMP) ## Check style, formatting, imports and types.
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/lint-imports --no-cache --no-logo
	@echo "Checking types (the first time takes about a minute) ..."
	@$(BIN)/mypy

format: $(STAMP) ## Format the code and fix what can be fixed.
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

# Material names MkDocs 2, which is not used here, in a banner.
docs: $(STAMP) ## Write the JSON schemas; build the site (build/site).
	@$(BIN)/python docs/json_schemas.py
	@NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --quiet $(ARGS)
	@echo "Open build/site/index.html; to search in it, serve it:" \
	  "$(BIN)/python -m http.server -d build/site"

# Each goes on whether or not the one before it met its goals.
bench: $(STAMP) ## Measure speed and reliability (about half an hour).
	@failed=0; for name in startup realtime cockpit hand_over users; do \
	  echo; echo "== benchmarks/$$name.py"; \
	  $(BIN)/python benchmarks/$$name.py || failed=1; \
	done; for name in walking tutorial; do \
	  echo; echo "== benchmarks/campaigns/$$name.yaml"; \
	  $(BIN)/atlas-drake sweep benchmarks/campaigns/$$name.yaml \
	    --seed $$(date +%s) --out build/bench/$$name-$$(date +%s) || failed=1; \
	done; exit $$failed

clean: ## Delete the environment, caches and builds.
	rm -rf $(VENV) build dist .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# The check for ensurepip comes first because its lack leaves a half-made folder.
$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "Python 3.11 or newer is needed; $(PYTHON) is" \
	    "$$($(PYTHON) --version 2>&1). Choose one: make PYTHON=python3.13"; \
	  exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "$(PYTHON) cannot create environments: the venv or ensurepip module is" \
	    "missing."; \
	  echo "On Debian or Ubuntu: sudo apt install python3-venv"; \
	  exit 1; }
	@echo "Creating $(VENV) ..."
	@$(PYTHON) -m venv $(VENV)

$(STAMP): pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing atlas-drake and its tools into $(VENV) (one to three minutes) ..."
	@$(call QUIETLY,$(BIN)/python -m pip install --disable-pip-version-check \
	  -c constraints.txt -e "$(EXTRAS)")
	@touch $@

# Each Python has the newest Drake that supports it: 3.11 the last one made for it, later
# ones today's. A fresh environment, so that nothing left over from an earlier one is
# pinned; the pins of the other Pythons stay as they are.
PINNED_FOR = $(shell $(PYTHON) -c 'import sys; print("<" if sys.version_info < (3, 12) else ">=")')

constraints: ## Pin the newest versions of all dependencies, for PYTHON's version.
	@echo "Resolving the newest versions in $(VENV)-fresh (one to three minutes) ..."
	@rm -rf $(VENV)-fresh
	@$(PYTHON) -m venv $(VENV)-fresh
	@$(call QUIETLY,$(VENV)-fresh/bin/python -m pip install \
	  --disable-pip-version-check -e "$(EXTRAS)")
	@{ echo "# Versions that are known to work together. Written by \`make constraints\`" \
	     "with Python 3.11"; \
	   echo "# and with a later one; do not edit."; \
	   { grep 'python_version' constraints.txt | grep -vF 'python_version $(PINNED_FOR) '; \
	     $(VENV)-fresh/bin/python -m pip freeze --exclude-editable --quiet \
	       | sed 's/$$/ ; python_version $(PINNED_FOR) "3.12"/'; } | LC_ALL=C sort -f; \
	 } > constraints.tmp
	@mv constraints.tmp constraints.txt
	@rm -rf $(VENV)-fresh
