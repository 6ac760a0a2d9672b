# Amontons: build, test, run. `make help` lists the targets.
# SPDX-License-Identifier: GPL-3.0-or-later

SHELL := /bin/bash
MAKEFLAGS += -r --no-print-directory
JOBS ?= $(shell nproc 2>/dev/null || sysctl -n hw.ncpu 2>/dev/null || echo 2)
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(JOBS)
endif
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:

# --- what the user may set ----------------------------------------------------------------------------------------
BUILD  ?= release#     release, portable (for other processors, too), debug, sanitize or races
WERROR ?=#             1: a warning of the compiler is an error
V      ?=#             1: show the commands as they are run
MPI    ?=#             1: bin/amontons-mpi and lib/libamontons-mpi.so, too, for several ranks, on MPI and PETSc
ARCH   ?= -march=native
PREFIX ?= /usr/local
PYTHON ?= python3
ifeq ($(origin FC),default)
FC := gfortran
endif
ifeq ($(origin CC),default)
CC := gcc
endif

# --- where things are ---------------------------------------------------------------------------------------------
BUILD := $(strip $(BUILD))
ifeq ($(BUILD),release)
B := build
BIN := bin
LIB := lib
else ifneq ($(filter $(BUILD),portable debug sanitize races),)
B := build/$(BUILD)
BIN := $(B)/bin
LIB := $(B)/lib
else
$(error BUILD is "$(BUILD)"; it can be release, portable, debug, sanitize or races)
endif
VENV := .venv
Q := $(if $(V),,@)
comma := ,
ABI := $(shell sed -n 's/^.define AMONTONS_ABI \([0-9]*\).*/\1/p' src/driver/amontons.h)#  the number behind libamontons.so
PY := $(VENV)/bin/python
DIST ?= dist
PYTHON_OF_TOOLS ?= $(abspath $(PY))

# --- compilers ----------------------------------------------------------------------------------------------------
# (Optimising, gfortran 12 takes the bounds of an array that is not yet allocated for variables used before they are
# set. Reals are compared with exactly zero on purpose: a load that is not there, a status that did not change.)
FWARN := -Wall -Wextra -pedantic -Wimplicit-interface -Wuse-without-only -Wconversion-extra \
  -Wno-maybe-uninitialized -Wno-uninitialized -Wno-compare-reals
CWARN := -Wall -Wextra -pedantic
OPT_release  := -O3 $(ARCH) -g
OPT_portable := -O3 $(if $(filter x86_64,$(shell uname -m)),-march=x86-64-v2) -g1
OPT_debug    := -O0 -g -fno-omit-frame-pointer
OPT_sanitize := -O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined
OPT_races    := -O1 -g -fno-omit-frame-pointer -fsanitize=thread
CHECK_debug    := -fcheck=all -fbacktrace -ffpe-trap=invalid,zero,overflow -finit-real=snan
CHECK_sanitize := -fcheck=all,no-array-temps -fbacktrace -finit-real=snan
UNIT_release := -O0#  the programs of the unit tests are compiled often and run once: a quarter of the time of -O1
# A product and a sum are rounded one by one, so that every processor gives the same digits (with the same kernels of the BLAS).
COMMON := $(OPT_$(BUILD)) -ffp-contract=off -fPIC -fopenmp $(if $(WERROR),-Werror)

# HDF5 by pkg-config where it is known there; then the usual places: Debian, Fedora, conda, Homebrew.
PLACES := $(CONDA_PREFIX) $(HOMEBREW_PREFIX)
HDF5_I := $(or $(shell pkg-config --cflags-only-I hdf5-serial 2>/dev/null || pkg-config --cflags-only-I hdf5 2>/dev/null), \
  $(addprefix -I,$(wildcard /usr/include/hdf5/serial)))
HDF5_L := $(or $(shell pkg-config --libs-only-L hdf5-serial 2>/dev/null || pkg-config --libs-only-L hdf5 2>/dev/null), \
  $(addprefix -L,$(wildcard /usr/lib/*/hdf5/serial)))
INCLUDES := $(HDF5_I) $(addprefix -I,$(wildcard /usr/include/suitesparse /usr/lib64/gfortran/modules \
  $(foreach p,$(PLACES),$(p)/include $(p)/include/suitesparse)))
LDLIBS := $(HDF5_L) $(foreach p,$(PLACES),-L$(p)/lib -Wl,-rpath,$(p)/lib) \
  -lopenblas -lumfpack -lcholmod -lamd -lcolamd -lsuitesparseconfig -lmetis -lhdf5_fortran -lhdf5 -lz -lm

# MPI and PETSc (Debian: libpetsc-real-dev) for MPI=1 alone.
ifeq ($(MPI),1)
PETSC_I := $(patsubst -I%,-isystem %,$(shell pkg-config --cflags-only-I petsc mpi-c 2>/dev/null))
PETSC_L := $(shell pkg-config --libs petsc mpi-c 2>/dev/null)
endif

FFLAGS := -std=f2018 -fimplicit-none $(COMMON) $(CHECK_$(BUILD)) $(FWARN)
CFLAGS := -std=c11 $(COMMON) $(CWARN)
export FC CC INCLUDES LDLIBS PYTHON MPI PETSC_I PETSC_L

# --- the modules --------------------------------------------------------------------------------------------------
# src/depends.mk is generated from the use lines by `make depends`; `make lint` proves that it is not stale.
include src/depends.mk
FOLDERS := $(patsubst %/,%,$(sort $(wildcard src/*/)))
MODULE_FILES := $(wildcard $(addsuffix /*.f90,$(FOLDERS)))
MODULES := $(basename $(notdir $(MODULE_FILES)))
SHIMS := $(filter-out petsc_shim,$(basename $(notdir $(wildcard $(addsuffix /*.c,$(FOLDERS))))))
OBJECTS := $(addprefix $(B)/,$(addsuffix .o,$(filter-out main,$(MODULES)) $(SHIMS)))
UNIT_SOURCES := $(wildcard verify/unit/*/test_*.f90)
UNITS := $(patsubst %.f90,$(B)/unit/%,$(notdir $(UNIT_SOURCES)))
PRODUCTS := $(LIB)/libamontons.a $(LIB)/libamontons.so $(BIN)/amontons
ifeq ($(MPI),1)
PRODUCTS += $(BIN)/amontons-mpi $(LIB)/libamontons-mpi.so
endif
INCLUDES += $(addprefix -I,$(FOLDERS))

# Sources are found in the folders of src; objects and .mod files lie side by side in $(B).
vpath %.f90 $(FOLDERS)
vpath %.c $(FOLDERS)
vpath %.h $(FOLDERS)
vpath %.inc $(FOLDERS)

# depends.mk says `uses_mesh = kinds topology`; here it becomes build/mesh.o: build/amontons_kinds.mod build/amontons_topology.mod.
# The compiler leaves a .mod as it is if the interface has not changed: then the modules that use it need not be compiled again.
define module_rule
$(B)/$(1).o: $(foreach used,$(filter $(MODULES),$(uses_$(1))),$(B)/amontons_$(used).mod)
$(B)/amontons_$(1).mod: $(B)/$(1).o ;
endef
$(foreach module,$(MODULES),$(eval $(call module_rule,$(module))))

.PHONY: picture report bench study study-newton study-gradients all build ready proven deps run programs test check ranks verify unit debug sanitize races format lint doc api install place uninstall deb pack-deb wheel pack-wheel hooks clean help depends

all: ready ## Build bin/amontons, lib/libamontons.a and lib/libamontons.so (BUILD=debug|sanitize|races: into build/debug, ...; WERROR=1; MPI=1: those for several ranks, too)
	@$(MAKE) build

build: $(PRODUCTS)
	@:

$(BIN)/amontons: $(B)/main.o $(LIB)/libamontons.a
	@echo "linking   $@" && mkdir -p $(@D)
	$(Q)$(FC) $(FFLAGS) -rdynamic -o $@ $^ $(LDLIBS)

# The same objects; the ranks and the distributed solver are those of MPI and PETSc.
OBJECTS_MPI = $(filter-out %/serial_shim.o,$(OBJECTS)) $(B)/petsc_shim.o
$(BIN)/amontons-mpi: $(B)/main.o $(OBJECTS_MPI)
	@echo "linking   $@" && mkdir -p $(@D)
	$(Q)$(FC) $(FFLAGS) -rdynamic -o $@ $^ $(LDLIBS) $(PETSC_L)

$(B)/petsc_shim.o: petsc_shim.c distributed_shim.h
	@echo "compiling $<" && mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) -Wno-pedantic $(INCLUDES) $(PETSC_I) -c $< -o $@

$(B)/user_shim.o $(B)/user_calls_shim.o: user_shim.h

$(LIB)/libamontons.a: $(OBJECTS)
	@echo "linking   $@" && mkdir -p $(@D) && rm -f $@
	$(Q)ar rcs $@ $^

$(LIB)/libamontons.so: $(OBJECTS)
$(LIB)/libamontons-mpi.so: $(OBJECTS_MPI)
$(LIB)/libamontons.so $(LIB)/libamontons-mpi.so:
	@echo "linking   $@" && mkdir -p $(@D)
	$(Q)$(FC) $(FFLAGS) -shared $(if $(filter Darwin,$(shell uname -s)),,-Wl$(comma)-soname$(comma)$(@F).$(ABI)) -o $@ $^ $(LDLIBS) \
	  $(if $(findstring -mpi,$@),$(PETSC_L))
	$(Q)ln -sf $(@F) $@.$(ABI)

$(B)/%.o: %.f90
	@echo "compiling $<  [$$(ls $(B)/*.o 2>/dev/null | wc -l)/$(words $(OBJECTS) main)]" && mkdir -p $(@D)
	$(Q)$(FC) $(FFLAGS) $(INCLUDES) -J$(B) -c $< -o $@

$(B)/%.o: %.c
	@echo "compiling $<" && mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) $(INCLUDES) -c $< -o $@

$(B)/suitesparse_shim.o $(B)/supernodes_shim.o: supernodes_shim.h
$(B)/supernodes_shim.o: supernodes_solve.h
$(B)/serial_shim.o: distributed_shim.h

$(addprefix $(B)/,$(addsuffix .o,dense woodbury_interface)): dense.inc

unit: $(UNITS) ## Build the unit test programs
	@:

.SECONDARY: $(B)/unit/check.o $(B)/unit/samples.o

$(B)/unit/%.o: verify/unit/%.f90 $(LIB)/libamontons.a
	@echo "compiling $<" && mkdir -p $(@D)
	$(Q)$(FC) $(FFLAGS) -I$(B) -J$(@D) -c $< -o $@

vpath test_%.f90 $(sort $(dir $(UNIT_SOURCES)))

$(B)/unit/test_%: test_%.f90 $(B)/unit/check.o $(B)/unit/samples.o $(LIB)/libamontons.a $(wildcard verify/unit/*.inc)
	@echo "compiling $<" && mkdir -p $@.modules
	$(Q)$(FC) $(FFLAGS) $(UNIT_$(BUILD)) -Wno-integer-division -I$(B) -I$(@D) -Iverify/unit $(INCLUDES) -J$@.modules -rdynamic -o $@ $(filter-out %.inc,$^) $(LDLIBS)

$(B)/kernels: verify/benchmark/kernels.f90 $(LIB)/libamontons.a
	@echo "compiling $<"
	$(Q)$(FC) $(FFLAGS) -I$(B) $(INCLUDES) -o $@ $^ $(LDLIBS)

debug: ready ## Build with all run-time checks into build/debug
	@$(MAKE) BUILD=debug build

sanitize: ready $(VENV)/installed ## Build with the address and undefined-behaviour sanitizers into build/sanitize, and run jobs under them
	@$(MAKE) BUILD=sanitize build
	@PYTHONPATH=python $(PY) -m verify.sanitizers.run --program build/sanitize/bin/amontons

races: ready $(VENV)/installed ## Build with ThreadSanitizer into build/races, and run jobs on two threads under it (gcc, Linux)
	@$(MAKE) BUILD=races build
	$(Q)$(CC) -std=c11 -O1 $(CWARN) -fPIC -shared -o build/races/gomp_order.so verify/sanitizers/gomp_order.c -ldl
	@PYTHONPATH=python $(PY) -m verify.sanitizers.run --program build/races/bin/amontons --preload build/races/gomp_order.so

# --- what must be there first -------------------------------------------------------------------------------------
deps: ready ## Install what is missing (Debian, Ubuntu: apt; elsewhere a list), and the Python packages into .venv
	@$(MAKE) $(VENV)/installed
	@echo "All that Amontons needs is there."

ready:
	@.ci/deps check || { .ci/deps install && $(MAKE) proven; }

# A second make, because the places of the headers are looked up when make starts.
proven:
	@.ci/deps check || { .ci/deps list; exit 1; }

# A link to an environment elsewhere is never written through: it has the packages, or make says so.
$(VENV)/installed: verify/requirements.txt | ready
ifneq ($(shell test -L $(VENV) && echo link),)
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-index --dry-run -r $< >/dev/null 2>&1 || { \
	  echo "$(VENV) is a link to $$(readlink $(VENV)), which lacks packages of $<: remove the link, or install them there." >&2; exit 1; }
else
	@echo "installing the Python packages of $< into $(VENV)"
	$(Q)$(PYTHON) -m venv --clear $(VENV)
	$(Q)$(PY) -m pip install --quiet --disable-pip-version-check --no-input -r $<
	@touch $@
endif

# --- running and testing ------------------------------------------------------------------------------------------
run: all $(VENV)/installed ## Run input/shear_block.inp with progress; results and a picture go to results/
	@mkdir -p results
	$(BIN)/amontons --outdir results input/shear_block.inp
	@PYTHONPATH=python $(PY) -m verify.tools.picture results/shear_block.vtkhdf
	@echo "The picture is results/shear_block.png; open results/shear_block.vtkhdf with ParaView for the rest."

picture: all $(VENV)/installed ## Draw JOB=job.vtkhdf to a PNG beside it, without a display (default: results/shear_block.vtkhdf)
	@PYTHONPATH=python $(PY) -m verify.tools.picture $(or $(JOB),results/shear_block.vtkhdf) $(OPTIONS)

report: all $(VENV)/installed ## Turn JOB=job.vtkhdf into one HTML page beside it (default: results/shear_block.vtkhdf)
	@PYTHONPATH=python $(PY) -m amontons.report $(or $(JOB),results/shear_block.vtkhdf) --program $(BIN)/amontons

programs: all
	@$(MAKE) unit

# Each test with one thread, and one test more at once than there are processors, because some wait: for the disk, for a routine that sleeps. Tests
# of threads set their own.
PYTEST = OMP_NUM_THREADS=$${OMP_NUM_THREADS:-1} AMONTONS_BIN=$(BIN) AMONTONS_LIB=$(LIB) AMONTONS_UNITS=$(B)/unit \
  $(PY) -m pytest -n $$(($(JOBS) + 1)) --dist loadgroup $(PYTEST_OPTIONS)

test: programs $(VENV)/installed $(VENV)-doc/installed $(VENV)-api/installed ## Run all tests, those of the documentation site among them
	@$(PYTEST) verify

check: programs $(VENV)/installed ## Run the fast tests (some minutes)
	@$(PYTEST) -m "not slow" verify --ignore verify/peers

ranks: all $(VENV)/installed ## With MPI=1: run the tests of several ranks, one at a time
	@$(PYTEST) -n 1 verify/distributed

verify: programs $(VENV)/installed ## Run the verification cases and write their pages to doc/verification
	@AMONTONS_PAGES=doc/verification $(PYTEST) verify/cases verify/peers

# The wide case of the bench: sizes, laws, formulations, thickness, mu (python -m verify.benchmark.wide_contact --help).
WIDE ?= --sizes 10 20 --law linear --type node --displacement --ccx --limit 600
bench: programs $(VENV)/installed ## Time against CalculiX (ccx, if installed) and write the table of doc/performance.md
	@$(MAKE) $(B)/kernels
	@$(PY) -m verify.benchmark.bench --program $(BIN)/amontons --kernels $(B)/kernels --write
	@$(PY) -m verify.benchmark.wide_contact --program $(BIN)/amontons $(WIDE)

study: study-newton study-gradients ## Iterations of all line searches by friction, shape and size of the increments: ironing, blocks, cylinder, ball

study-newton: programs $(VENV)/installed ## The first half of it: Newton's method
	@$(PY) -m verify.study.ironing_table --program $(BIN)/amontons
	@$(PY) -m verify.study.line_search_table --program $(BIN)/amontons
	@$(PY) -m verify.study.line_search_table --program $(BIN)/amontons --direction SYMMETRIC --seconds 60
	@$(PY) -m verify.study.line_search_table --program $(BIN)/amontons --direction LAGGED --seconds 60
	@$(PY) -m verify.study.random_contact --program $(BIN)/amontons --seeds 1 200
	@$(PY) -m verify.study.contact_table --program $(BIN)/amontons --runs $(B)/study.csv
	@$(PY) -m verify.study.contact_table --show $(B)/study.csv

GRADIENTS = $(PY) -m verify.study.gradients_table --program $(BIN)/amontons --runs $(B)/gradients.csv --outdir $(B)/gradients
study-gradients: programs $(VENV)/installed ## The second half of it: conjugate gradients
	@$(GRADIENTS) --preconditioners NODAL --only "block sheared" punch "block dragged" cylinder ball "ball by faces"
	@$(GRADIENTS) --preconditioners FACTOR --only "block sheared" punch "block dragged" --seconds-others 6
	@$(GRADIENTS) --preconditioners FACTOR --only cylinder ball "ball by faces" "ironing curved" "ironing flat"
	@$(GRADIENTS) --preconditioners NODAL --only "ironing curved" "ironing flat" --seconds 20
	@$(PY) -m verify.study.gradients_table --show $(B)/gradients.csv --figure $(B)/gradients.png
	@$(PY) -m verify.study.gradients_samples --program $(BIN)/amontons
	@$(PY) -m verify.study.gradients_growth --program $(BIN)/amontons

# --- the documentation --------------------------------------------------------------------------------------------
doc: all $(VENV)-doc/installed ## Build the documentation site into build/site, and the pages of the source into build/site/api
	$(BIN)/amontons --cards | $(PYTHON) -m verify.tools.card_reference > doc/manual/cards.md
	$(PYTHON) -m verify.tools.module_table > doc/developer/modules.md
	$(Q)NO_MKDOCS_2_WARNING=1 $(VENV)-doc/bin/mkdocs build
	@$(MAKE) api
	@$(PYTHON) -m verify.tools.site_weight build/site
	@echo "The site is build/site/index.html."

api: $(VENV)-api/installed $(VENV)-doc/installed ## Build the pages of the source (FORD) into build/site/api
	$(Q)$(VENV)-doc/bin/python -m verify.tools.api_pages $(VENV)-api/bin/ford build/site/api

$(VENV)-doc/installed: doc/requirements.txt
$(VENV)-api/installed: doc/requirements-api.txt
$(VENV)-doc/installed $(VENV)-api/installed: | ready
	@echo "installing the Python packages of $< into $(@D)"
	$(Q)$(PYTHON) -m venv --clear $(@D)
	$(Q)$(@D)/bin/python -m pip install --quiet --disable-pip-version-check --no-input -r $<
	@touch $@

# --- the look of the source ---------------------------------------------------------------------------------------
SOURCES = $(MODULE_FILES) $(wildcard verify/unit/*.f90) $(UNIT_SOURCES)

format: $(VENV)/installed ## Put the white space of the Fortran files in order
	@$(PY) -m verify.tools.layout $(SOURCES)

depends: ## Generate src/depends.mk from the use lines
	@$(PYTHON) -m verify.tools.lint --write

lint: $(VENV)/installed ## Prove the layers of src, the limits of style.md, the white space, and fortitude's rules
	@failed=0; \
	  $(PY) -m verify.tools.lint || failed=1; \
	  $(PY) -m verify.tools.layout --check $(SOURCES) || failed=1; \
	  $(VENV)/bin/fortitude check --output-format concise $(SOURCES) || failed=1; \
	  exit $$failed

hooks: ## Make git run `make lint` before each commit
	@printf '#!/bin/sh\nexec make lint\n' > "$$(git rev-parse --git-path hooks/pre-commit)"
	@chmod +x "$$(git rev-parse --git-path hooks/pre-commit)"

# --- the rest -----------------------------------------------------------------------------------------------------
install: all ## Install program, library, Python package, examples, man page and completions below PREFIX (default /usr/local)
	@$(MAKE) place

VERSION = $(shell sed -n "s/.*VERSION = '\(.*\)'.*/\1/p" src/base/version.f90)
SHARE = $(DESTDIR)$(PREFIX)/share
fill = sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' $(1) > $(2)

# What is built already goes to its places. Python packages go where PYTHON_SITE says, for the Python that runs amontons-report.
PYTHON_SITE ?= $(PREFIX)/lib/python3/dist-packages
EXAMPLES := $(wildcard input/*.inp input/*.mesh)
PACKAGE := $(wildcard python/amontons/*.py python/amontons/py.typed)
REPORT := $(wildcard python/amontons/report/*.py python/amontons/report/*.css python/amontons/report/*.js)
place:
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/pkgconfig $(DESTDIR)$(PREFIX)/lib/cmake/amontons
	install -d $(DESTDIR)$(PREFIX)/include/amontons $(SHARE)/man/man1 $(SHARE)/bash-completion/completions $(SHARE)/zsh/site-functions \
	  $(SHARE)/fish/vendor_completions.d $(SHARE)/amontons/examples $(DESTDIR)$(PYTHON_SITE)/amontons/report
	install $(BIN)/amontons share/amontons-ccx $(DESTDIR)$(PREFIX)/bin
	$(call fill,share/amontons-report.in,$(DESTDIR)$(PREFIX)/bin/amontons-report)
	chmod 755 $(DESTDIR)$(PREFIX)/bin/amontons-report
	install -m 644 $(LIB)/libamontons.a $(DESTDIR)$(PREFIX)/lib
	install -m 644 $(LIB)/libamontons.so $(DESTDIR)$(PREFIX)/lib/libamontons.so.$(ABI)
	ln -sf libamontons.so.$(ABI) $(DESTDIR)$(PREFIX)/lib/libamontons.so
	$(if $(filter 1,$(MPI)),install $(BIN)/amontons-mpi $(DESTDIR)$(PREFIX)/bin)
	$(if $(filter 1,$(MPI)),install -m 644 $(LIB)/libamontons-mpi.so $(DESTDIR)$(PREFIX)/lib/libamontons-mpi.so.$(ABI))
	$(if $(filter 1,$(MPI)),ln -sf libamontons-mpi.so.$(ABI) $(DESTDIR)$(PREFIX)/lib/libamontons-mpi.so)
	install -m 644 src/driver/amontons.h $(DESTDIR)$(PREFIX)/include
	install -m 644 $(B)/amontons_*.mod $(DESTDIR)$(PREFIX)/include/amontons
	install -m 644 $(PACKAGE) $(DESTDIR)$(PYTHON_SITE)/amontons
	install -m 644 $(REPORT) $(DESTDIR)$(PYTHON_SITE)/amontons/report
	install -m 644 $(EXAMPLES) $(SHARE)/amontons/examples
	$(call fill,share/amontons.pc.in,$(DESTDIR)$(PREFIX)/lib/pkgconfig/amontons.pc)
	$(call fill,share/amontonsConfig.cmake.in,$(DESTDIR)$(PREFIX)/lib/cmake/amontons/amontonsConfig.cmake)
	$(call fill,share/amontonsConfigVersion.cmake.in,$(DESTDIR)$(PREFIX)/lib/cmake/amontons/amontonsConfigVersion.cmake)
	$(call fill,share/amontons.1,$(SHARE)/man/man1/amontons.1)
	install -m 644 share/amontons.bash $(SHARE)/bash-completion/completions/amontons
	install -m 644 share/_amontons $(SHARE)/zsh/site-functions/_amontons
	install -m 644 share/amontons.fish $(SHARE)/fish/vendor_completions.d/amontons.fish

uninstall: ## Remove what `make install` put below PREFIX
	rm -f $(addprefix $(DESTDIR)$(PREFIX)/,bin/amontons bin/amontons-ccx bin/amontons-report lib/libamontons.a lib/libamontons.so \
	  lib/libamontons.so.$(ABI) bin/amontons-mpi lib/libamontons-mpi.so lib/libamontons-mpi.so.$(ABI) lib/pkgconfig/amontons.pc include/amontons.h)
	rm -f $(SHARE)/man/man1/amontons.1 $(SHARE)/bash-completion/completions/amontons $(SHARE)/zsh/site-functions/_amontons \
	  $(SHARE)/fish/vendor_completions.d/amontons.fish
	rm -rf $(DESTDIR)$(PREFIX)/include/amontons $(DESTDIR)$(PREFIX)/lib/cmake/amontons $(SHARE)/amontons $(DESTDIR)$(PYTHON_SITE)/amontons

# The package of what BUILD=portable built; Debian's own tools find the libraries that it needs.
deb: ready ## Build a Debian package into dist
	@$(MAKE) BUILD=portable build
	@$(MAKE) BUILD=portable pack-deb

DEB := build/deb
PACKING ?=#             options of dpkg-deb and auditwheel: the tests pack with little compression, -z1
pack-deb:
	@rm -rf $(DEB) && mkdir -p $(DEB)/tree/DEBIAN $(DEB)/debian $(DIST)
	@$(MAKE) place B=$(B) BIN=$(BIN) LIB=$(LIB) DESTDIR=$(abspath $(DEB))/tree PREFIX=/usr PYTHON_SITE=/usr/lib/python3/dist-packages >/dev/null
	@strip --strip-debug $(DEB)/tree/usr/bin/amontons $(DEB)/tree/usr/lib/libamontons.so.$(ABI) $(DEB)/tree/usr/lib/libamontons.a
	@install -d $(DEB)/tree/usr/share/doc/amontons && install -m 644 LICENSE $(DEB)/tree/usr/share/doc/amontons/copyright
	@printf 'Source: amontons\n\nPackage: amontons\nArchitecture: any\n' > $(DEB)/debian/control
	@needs=$$(cd $(DEB) && dpkg-shlibdeps -O tree/usr/bin/amontons tree/usr/lib/libamontons.so.$(ABI) 2>/dev/null | sed 's/^shlibs:Depends=//'); \
	  test -n "$$needs" && sed "s|@VERSION@|$(VERSION)|; s|@ARCH@|$$(dpkg --print-architecture)|; s|@NEEDS@|$$needs|" share/control.in \
	  > $(DEB)/tree/DEBIAN/control
	@printf '#!/bin/sh\nldconfig\n' | tee $(DEB)/tree/DEBIAN/postinst > $(DEB)/tree/DEBIAN/postrm
	@chmod 755 $(DEB)/tree/DEBIAN/postinst $(DEB)/tree/DEBIAN/postrm
	$(Q)dpkg-deb --root-owner-group $(PACKING) --build $(DEB)/tree $(DIST)
	@rm -rf $(DEB)

wheel: ready $(VENV)/installed ## Build the Python package with library, program and all they need into dist (Linux, any x86-64 since 2009)
	@$(MAKE) BUILD=portable build
	@$(MAKE) BUILD=portable pack-wheel

# What is built already becomes a wheel; auditwheel adds OpenBLAS, SuiteSparse, HDF5 and what these need.
pack-wheel:
	@rm -rf $(B)/wheel && mkdir -p $(B)/wheel $(DIST)
	$(Q)AMONTONS_LIB=$(LIB) AMONTONS_BIN=$(BIN) $(PYTHON_OF_TOOLS) -m pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation \
	  --wheel-dir $(B)/wheel ./python
	$(Q)PATH="$(dir $(PYTHON_OF_TOOLS)):$$PATH" $(PYTHON_OF_TOOLS) -m auditwheel repair $(PACKING) --wheel-dir $(DIST) $(B)/wheel/amontons-*.whl
	@rm -rf $(B)/wheel

clean: ## Remove all that make built, but not .venv
	rm -rf build bin lib results dist python/build python/*.egg-info

help: ## Print this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))
