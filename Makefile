# make            set up .venv and run the study (the paper's tables, figures and report appear in results/)
# make start FILE=my-swing.csv   from a recording, or a folder of them, to what damps the pendulum and what a model of it lacks; or FILE=mine.yaml, a study of your own
# make quick      format, lint, types, imports, units, frozen verdicts, answers and files: what to run before each commit (some minute)
# make test       set up .venv and run the tests; make test-all runs the slow ones too
# make sanitize   run the engine's tests with its C checked for errors of memory and undefined behaviour (ASan, UBSan; some minutes)
# make certified  compute published cases with known answers (NIST, GUM, York, ISO/TS 28037): results/trust/certified.csv
# make coverage   how often stated 95 % intervals hold the truth, in simulated measurements: results/coverage/coverage.csv (some half an hour)
# make benchmark  time the engine against what one would otherwise use (sets up .venv/peers for that; some ten minutes; ARGS=--quick: one)
# make benchmark-discovery  hold the search for hidden effects against what one would otherwise use (after snakemake hidden_effects;
#                 sets up .venv/discovery for that; some minutes)
# make docs       the site of docs/, with catalogue, settings and API: site/index.html (sets up .venv/docs for that)
# make wheel      the package as a wheel that carries the compiled engine, so that no compiler is needed: dist/
# make lock       resolve the versions again after a change of pyproject.toml; UPGRADE=--upgrade takes newer ones
# make clean      remove what was computed; make distclean removes .venv as well
#
# VERSIONS=highest sets up .venv with the newest versions of what the package needs itself, VERSIONS=lowest-direct with the lowest allowed.
# TARGET=report, CORES=4 and ARGS="--configfile mine.yaml" are passed on to snakemake; TESTS=tests/fitting/test_fit.py to pytest (of quick, too).

PYTHON ?= python3
CORES ?= 2
TARGET ?= all
ARGS ?=
FILE ?=
TESTS ?= tests
VERSIONS ?=
EXTRAS := capture,cluster,workflow
# A file of tests stays in one process: what its tests share is made once. One process more than cores: recordings, clusters and
# terminals mostly wait.
WORKERS := -n $(shell expr $(CORES) + 1) --dist loadfile --no-loadscope-reorder

BIN := .venv/bin
# Named after the locks' contents and this folder, so that the environment is laid anew when, and only when, they change.
READY := .venv/ready-$(shell (pwd; $(if $(VERSIONS),echo $(VERSIONS);) cat requirements.lock requirements-uv.lock pyproject.toml) | cksum | cut -d' ' -f1)

.PHONY: run start there venv quick test test-all sanitize certified coverage benchmark benchmark-discovery docs wheel lock clean distclean
.DELETE_ON_ERROR:

run: $(READY)
	@$(BIN)/snakemake -c$(CORES) $(TARGET) $(ARGS)

# A file, or a folder of files that are a pendulum each; ARGS="--together --unit deg" is passed on (swingdown --help tells all).
start: there $(READY)
	@$(BIN)/swingdown "$(FILE)" $(ARGS)

# Asked before anything is set up.
there:
	@test -n "$(FILE)" || { echo 'Which file? Mend: make start FILE=path/to/my-swing.csv (or a folder of them)' >&2; exit 2; }
	@test -e "$(FILE)" || { echo 'There is no file or folder $(FILE). Mend: correct the path' >&2; exit 2; }

venv: $(READY)

$(READY):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed; this is %s. Mend: make PYTHON=/path/to/a/newer/python3" % sys.version.split()[0])'
	@echo "Setting up .venv (once; the versions are those of requirements.lock) ..."
	@$(PYTHON) -m venv --clear .venv
	@if $(BIN)/python -m pip install -q --disable-pip-version-check --require-hashes -r requirements-uv.lock \
	  && $(BIN)/uv pip sync -q --system-certs --require-hashes --python $(BIN)/python requirements.lock requirements-uv.lock; then :; \
	else echo "uv did not manage; falling back to pip, which is slower ..." \
	  && $(BIN)/python -m pip install -q --disable-pip-version-check --require-hashes -r requirements.lock; fi
	@$(BIN)/python -m pip install -q --disable-pip-version-check --no-deps --no-build-isolation -e .
	@$(if $(VERSIONS),$(BIN)/uv pip install -q --system-certs --python $(BIN)/python --no-build-isolation --upgrade --resolution $(VERSIONS) -e '.[$(EXTRAS)]',:)
	@unset PYTHONDONTWRITEBYTECODE; ($(BIN)/python -c '$(IMPORT_ALL)'; $(BIN)/snakemake --dry-run --quiet all) > /dev/null 2>&1 || :
	@touch $@

# Once over all that a run imports, so that it lies there compiled: otherwise, and for ever where the environment forbids Python
# to write what it compiles, every process compiles it anew.
IMPORT_ALL := import importlib, pkgutil, swingdown; \
  [importlib.import_module(one.name) for one in pkgutil.walk_packages(swingdown.__path__, "swingdown.")]

# Chosen by what they take: a file is here where all its tests together take some seconds of one core. Both cores take from one heap,
# whichever file a test is of.
QUICK := $(addprefix tests/, answer/test_frozen_answers.py test_imports.py test_lint.py test_types.py test_dataset.py test_quantisation.py test_rounding.py test_schema.py \
  discovery/test_frozen.py discovery/test_losses.py discovery/test_verdict.py engine/test_elementary.py engine/test_refusals.py engine/test_sticking.py engine/test_trajectory.py \
  fitting/test_covariance.py fitting/test_fit.py fitting/test_guess.py fitting/test_nelder_mead.py fitting/test_starts.py \
  measurement/test_angle.py measurement/test_bounds.py measurement/test_frozen_door.py measurement/test_recording.py measurement/test_sheet.py measurement/test_straight_line.py \
  pendulum/test_formula.py pendulum/test_model.py)

quick: $(READY)
	@$(BIN)/python -m pytest -n $(CORES) --dist worksteal -q --tb short -rfE --disable-warnings $(if $(filter file,$(origin TESTS)),$(QUICK),$(TESTS)) \
	  || { echo 'NOT IN ORDER: each line FAILED above says which test, and what it found. Mend of format and lint: $(BIN)/ruff format . && $(BIN)/ruff check --fix .' >&2; exit 1; }

test: $(READY)
	@$(BIN)/python -m pytest $(WORKERS) $(TESTS)

test-all: $(READY)
	@SWINGDOWN_SLOW=1 $(BIN)/python -m pytest $(WORKERS) --durations 30 $(TESTS)

# The interpreter is not built with the sanitizer, so its library comes first; what Python keeps until its end is no leak.
sanitize: $(READY)
	@CC="gcc -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all" \
	  LD_PRELOAD="$$(gcc -print-file-name=libasan.so) $$(gcc -print-file-name=libstdc++.so)" ASAN_OPTIONS=detect_leaks=0 \
	  $(BIN)/python -m pytest $(WORKERS) $(if $(filter file,$(origin TESTS)),tests/engine,$(TESTS))

certified: $(READY)
	@$(BIN)/snakemake -c1 certified $(ARGS)

coverage: $(READY)
	@$(BIN)/snakemake -c$(CORES) coverage $(ARGS)

PEERS := .venv/peers-$(shell cksum < requirements-benchmark.lock | cut -d' ' -f1)

# One thread each, so that CPU times compare; without the peers' packages the rest is timed all the same.
benchmark: $(READY)
	@test -e $(PEERS)/ready || { echo "Setting up the peers ($(PEERS), once, 1.6 GB) ..." && $(PYTHON) -m venv --clear $(PEERS) \
	  && $(BIN)/uv pip sync -q --system-certs --require-hashes --python $(PEERS)/bin/python requirements-benchmark.lock \
	  && touch $(PEERS)/ready; } || echo "The peers could not be set up; what needs them is left out."
	@OPENBLAS_NUM_THREADS=1 XLA_FLAGS="--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1" PYTHONPATH=workflow/src:tests/engine \
	  $$(test -e $(PEERS)/ready && echo $(PEERS)/bin/python || echo $(BIN)/python) tests/benchmarks/fits.py $(ARGS)

DISCOVERY := .venv/discovery-$(shell cksum < requirements-discovery.lock | cut -d' ' -f1)

# On the campaigns that snakemake hidden_effects left in results; ARGS="--hidden elsewhere/results/hidden_effects" takes others.
benchmark-discovery: $(READY)
	@test -e $(DISCOVERY)/ready || { echo "Setting up pysindy ($(DISCOVERY), once, 500 MB) ..." && $(PYTHON) -m venv --clear $(DISCOVERY) \
	  && $(BIN)/uv pip sync -q --system-certs --require-hashes --python $(DISCOVERY)/bin/python requirements-discovery.lock \
	  && touch $(DISCOVERY)/ready; } || echo "pysindy could not be set up; what needs it is left out."
	@OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 PYTHONPATH=workflow/src \
	  $$(test -e $(DISCOVERY)/ready && echo $(DISCOVERY)/bin/python || echo $(BIN)/python) tests/benchmarks/hidden/run.py $(ARGS)

DOCS := .venv/docs-$(shell cksum < requirements-docs.lock | cut -d' ' -f1)

# Whatever is not as it should be, a link that leads nowhere say, ends it.
docs: $(READY)
	@test -e $(DOCS)/ready || { echo "Setting up Sphinx ($(DOCS), once) ..." && $(PYTHON) -m venv --clear $(DOCS) \
	  && $(BIN)/uv pip sync -q --system-certs --require-hashes --python $(DOCS)/bin/python requirements-docs.lock \
	  && touch $(DOCS)/ready; }
	@unset PYTHONDONTWRITEBYTECODE; PYTHONPATH=workflow/src $(DOCS)/bin/python docs/generate.py docs/generated
	@unset PYTHONDONTWRITEBYTECODE; $(DOCS)/bin/python -m sphinx -q -W --keep-going -c docs . site
	@echo "site/index.html"

wheel: $(READY)
	@PYTHON=$(BIN)/python tools/build-wheel dist
	@ls dist/*.whl

lock:
	@$(PYTHON) -m venv --clear .venv
	@$(BIN)/python -m pip install -q --disable-pip-version-check uv
	@$(BIN)/uv pip compile -q pyproject.toml --extra test --output-file requirements.lock $(LOCK)
	@$(BIN)/uv pip compile -q pyproject.toml --extra benchmark -c requirements.lock --output-file requirements-benchmark.lock $(LOCK)
	@$(BIN)/uv pip compile -q pyproject.toml --extra peers -c requirements.lock --output-file requirements-discovery.lock $(LOCK)
	@$(BIN)/uv pip compile -q pyproject.toml --extra docs -c requirements.lock --output-file requirements-docs.lock $(LOCK)
	@$(BIN)/uv --version | sed 's/^uv \([^ ]*\).*/uv==\1/' | $(BIN)/uv pip compile -q - --output-file requirements-uv.lock $(LOCK)

LOCK := --system-certs $(UPGRADE) --universal --python-version 3.11 --generate-hashes \
  --no-emit-index-url --no-emit-find-links --no-header --no-annotate

clean:
	@rm -rf results site docs/generated .snakemake .pytest_cache .mypy_cache .ruff_cache

distclean: clean
	@rm -rf .venv
