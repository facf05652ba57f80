# ambiance: GNU make, no generator. `make help` lists the targets.
#
# A file named *_wide.c is compiled once per instruction set; core/, shade/ and tests/ ones also at one lane.
# Everything else is compiled once. CC=gcc or CC=clang; BUILD=dir keeps builds apart.

ifeq ($(origin CC),default)
CC := $(if $(shell command -v clang 2>/dev/null),clang,gcc)
endif
# Jobs at once: all processors, unless told otherwise (make JOBS=1).
JOBS    ?= $(shell nproc)
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(JOBS)
endif
BUILD   ?= build
PREFIX  ?= /usr/local
ASSETS  ?= pack
CCACHE  ?= $(shell command -v ccache 2>/dev/null)
OPT     ?= -O2
SANITIZE ?=
VERSION := 0.1.0

# One list for a fresh Debian 12: what `make demo` and `make test` install when it is missing.
PACKAGES := clang gcc libomp-dev libclang-rt-14-dev llvm pkg-config libembree-dev libopenexr-dev openexr libassimp-dev libstb-dev \
            libpng-dev libmd-dev zlib1g-dev libjansson-dev libcmocka-dev libegl-dev libgles-dev libegl-mesa0 libgl1-mesa-dri
export PACKAGES

LIBS_PKG := OpenEXR assimp stb libpng libmd
comma := ,

# ---- flags ----------------------------------------------------------------------------------------------------------
# The promise "same bits everywhere" rests on -ffp-contract=off and on nothing from fast-math (docs/determinism.md).
WARN    := -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wstrict-prototypes -Wmissing-prototypes \
           -Wno-bool-operation -Wno-psabi
EXACT   := -ffp-contract=off -fno-math-errno -fno-trapping-math
CPPFLAGS += -Iinclude -I. -D_GNU_SOURCE -DAMB_VERSION='"$(VERSION)"' -isystem /usr/include/OpenEXR \
            -isystem /usr/include/Imath -isystem /usr/include/stb
CFLAGS  += -std=c17 $(OPT) -g1 -fPIC -fopenmp -fvisibility=default $(EXACT) $(WARN) $(SANITIZE)
# The build ID tells the cache of made assets that the code changed.
LDFLAGS += -fopenmp -Wl,--build-id=sha1 $(SANITIZE)
LDLIBS  += -lembree3 -lOpenEXRCore-3_1 -lassimp -lstb -lpng -lmd -lz -lm

MACHINE := $(shell uname -m)
ifeq ($(MACHINE),x86_64)
LANES := 4 8 16
ISA_4  := -march=x86-64-v2
ISA_8  := -march=x86-64-v3
ISA_16 := -march=x86-64-v4 -mprefer-vector-width=512
else
LANES := 4
endif

# ---- sources --------------------------------------------------------------------------------------------------------
LIB_DIRS  := core shade raster march post io scenes
LIB_SRC   := $(sort $(wildcard $(addsuffix /*.c,$(LIB_DIRS))) $(wildcard scenes/builtin/*.c))
CLI_SRC   := $(sort $(wildcard cli/*.c))
BENCH_SRC := $(sort $(wildcard bench/*.c))
TEST_PROG := $(sort $(wildcard tests/test_*.c))
FUZZ_PROG := $(sort $(wildcard tests/fuzz_*.c))
TEST_SRC  := $(filter-out $(TEST_PROG) $(FUZZ_PROG),$(sort $(wildcard tests/*.c)))

# objects(sources): one per instruction set for *_wide.c, one otherwise
wide    = $(filter %_wide.c,$(1))
plain   = $(filter-out %_wide.c,$(1))
lanes   = $(LANES) $(if $(filter core/% shade/% tests/%,$(1)),1)
objects = $(patsubst %.c,$(BUILD)/obj/%.o,$(call plain,$(1))) \
          $(foreach s,$(call wide,$(1)),$(foreach l,$(call lanes,$(s)),$(BUILD)/obj/$(s:.c=).x$(l).o))

LIB_OBJ   := $(call objects,$(LIB_SRC))
CLI_OBJ   := $(call objects,$(CLI_SRC))
BENCH_OBJ := $(call objects,$(BENCH_SRC))
TEST_OBJ  := $(call objects,$(TEST_SRC))
TESTS     := $(patsubst tests/%.c,$(BUILD)/tests/%,$(TEST_PROG))
FUZZERS   := $(patsubst tests/%.c,$(BUILD)/tests/%,$(FUZZ_PROG))

.PHONY: all lib
all: $(BUILD)/ambiance $(BUILD)/libambiance.so
lib: $(BUILD)/libambiance.a

# ---- rules ----------------------------------------------------------------------------------------------------------
COMPILE = @mkdir -p $(@D) && echo "  cc    $@" && $(CCACHE) $(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP

$(BUILD)/obj/%.x1.o: %.c $(BUILD)/flags
	$(COMPILE) -DAMB_LANES=1 -c -o $@ $<
$(BUILD)/obj/%.x4.o: %.c $(BUILD)/flags
	$(COMPILE) $(ISA_4) -DAMB_LANES=4 -c -o $@ $<
$(BUILD)/obj/%.x8.o: %.c $(BUILD)/flags
	$(COMPILE) $(ISA_8) -DAMB_LANES=8 -c -o $@ $<
$(BUILD)/obj/%.x16.o: %.c $(BUILD)/flags
	$(COMPILE) $(ISA_16) -DAMB_LANES=16 -c -o $@ $<
$(BUILD)/obj/%.o: %.c $(BUILD)/flags
	$(COMPILE) -c -o $@ $<

$(BUILD)/libambiance.a: $(LIB_OBJ)
	@echo "  ar    $@"; rm -f $@; ar rcs $@ $(LIB_OBJ)
$(BUILD)/libambiance.so: $(LIB_OBJ)
	@echo "  ld    $@"; $(CC) -shared -Wl,-soname,libambiance.so.0 -o $@ $(LIB_OBJ) $(LDFLAGS) $(LDLIBS)
$(BUILD)/ambiance: $(CLI_OBJ) $(BUILD)/libambiance.a
	@echo "  ld    $@"; $(CC) -o $@ $(CLI_OBJ) $(BUILD)/libambiance.a $(LDFLAGS) $(LDLIBS) -ljansson
$(BUILD)/ambiance-bench: $(BENCH_OBJ) $(BUILD)/libambiance.a
	@echo "  ld    $@"; $(CC) -o $@ $(BENCH_OBJ) $(BUILD)/libambiance.a $(LDFLAGS) $(LDLIBS) -lEGL -lGLESv2
$(BUILD)/libtests.a: $(TEST_OBJ)
	@echo "  ar    $@"; rm -f $@; ar rcs $@ $(TEST_OBJ)
$(BUILD)/tests/test_%: $(BUILD)/obj/tests/test_%.o $(BUILD)/libtests.a $(BUILD)/libambiance.a
	@mkdir -p $(@D); echo "  ld    $@"; $(CC) -o $@ $^ $(LDFLAGS) $(LDLIBS) -lcmocka -lm
$(BUILD)/tests/fuzz_%: $(BUILD)/obj/tests/fuzz_%.o $(BUILD)/libtests.a $(BUILD)/libambiance.a
	@mkdir -p $(@D); echo "  ld    $@"; $(CC) -fsanitize=fuzzer -o $@ $^ $(LDFLAGS) $(LDLIBS)

# Rebuild when the compiler or the flags change.
FLAGS_NOW := $(CC) $(CPPFLAGS) $(CFLAGS) $(ISA_4) $(ISA_8) $(ISA_16)
$(BUILD)/flags: force
	@mkdir -p $(@D); echo '$(subst ','\'',$(FLAGS_NOW))' | cmp -s - $@ || echo '$(subst ','\'',$(FLAGS_NOW))' > $@
.PHONY: force
force:

-include $(patsubst %.o,%.d,$(LIB_OBJ) $(CLI_OBJ) $(BENCH_OBJ) $(TEST_OBJ) \
           $(patsubst tests/%.c,$(BUILD)/obj/tests/%.o,$(TEST_PROG) $(FUZZ_PROG)))

# ---- tests ----------------------------------------------------------------------------------------------------------
.PHONY: check test
check: $(TESTS) $(BUILD)/ambiance ## this build's unit and property tests (about a minute)
	@CC=$(CC) tests/build_rules.sh $(BUILD)
	@failed=; for t in $(TESTS); do \
	    echo "== $$t"; AMBIANCE=$(BUILD)/ambiance AMBIANCE_CACHE=$(BUILD)/cache $$t > $$t.log 2>&1 && tail -n 1 $$t.log || { failed="$$failed $$t"; cat $$t.log; }; \
	done; \
	test -z "$$failed" || { echo "failed:$$failed"; exit 1; }

test: deps ## everything: both compilers, goldens, installed library, sanitizers, short fuzzing (from nothing)
	$(MAKE) CC=clang all check
	$(MAKE) CC=gcc BUILD=$(BUILD)/gcc all check
	$(MAKE) CC=clang golden
	$(MAKE) CC=clang test-install
	$(MAKE) sanitize
	$(MAKE) tsan
	$(MAKE) fuzz FUZZ_LIMIT="-seed=1 -runs=4000"
	@echo "all tests passed"

.PHONY: asan ubsan sanitize tsan fuzz
SAN := -fno-omit-frame-pointer -fno-sanitize-recover=all
export LSAN_OPTIONS := suppressions=$(CURDIR)/tests/lsan.supp:print_suppressions=0
asan: ## the tests under AddressSanitizer and LeakSanitizer
	$(MAKE) CC=clang BUILD=$(BUILD)/asan SANITIZE="-fsanitize=address $(SAN)" OPT=-O1 check
ubsan: ## the tests under UndefinedBehaviorSanitizer
	$(MAKE) CC=clang BUILD=$(BUILD)/ubsan SANITIZE="-fsanitize=undefined $(SAN)" OPT=-O1 check
sanitize: ## both of them in one build
	$(MAKE) CC=clang BUILD=$(BUILD)/sanitize SANITIZE="-fsanitize=address$(comma)undefined $(SAN)" OPT=-O1 check

# Archer tells ThreadSanitizer about OpenMP's own synchronisation.
TSAN_TESTS ?= test_core test_raster test_raster_state test_tessellation test_patches test_geometry test_raster_targets test_raster_random test_rays test_post
ARCHER     := $(firstword $(wildcard /usr/lib/llvm-*/lib/libarcher.so))
tsan: ## the tests that run on several threads under ThreadSanitizer
	OMP_TOOL_LIBRARIES=$(ARCHER) TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1 suppressions=$(CURDIR)/tests/tsan.supp" \
	    $(MAKE) CC=clang BUILD=$(BUILD)/tsan SANITIZE="-fsanitize=thread" OPT=-O1 tsan-run
.PHONY: tsan-run
tsan-run: $(addprefix $(BUILD)/tests/,$(TSAN_TESTS))
	@for t in $^; do echo "== $$t (threads)"; $$t > $$t.log 2>&1 && tail -n 1 $$t.log || { cat $$t.log; exit 1; }; done

SECONDS ?= 60
FUZZ_LIMIT ?= -max_total_time=$(SECONDS)
fuzz: ## every fuzz target for SECONDS each, from its corpus in tests/data, under AddressSanitizer and UBSan
	$(MAKE) CC=clang BUILD=$(BUILD)/fuzz SANITIZE="-fsanitize=address$(comma)undefined$(comma)fuzzer-no-link $(SAN)" OPT=-O1 fuzz-run
.PHONY: fuzz-run
fuzz-run: $(FUZZERS)
	@for f in $^; do name=$$(basename $$f); mkdir -p $(BUILD)/corpus/$$name; echo "== $$name $(FUZZ_LIMIT)"; \
	    $$f $(FUZZ_LIMIT) -timeout=10 -rss_limit_mb=2048 -verbosity=0 -print_final_stats=1 \
	        -artifact_prefix=$(BUILD)/corpus/$$name- $(BUILD)/corpus/$$name $$(ls -d tests/data/$$name 2>/dev/null) \
	        > $$f.log 2>&1 && grep -E 'number_of_executed_units' $$f.log || { tail -n 40 $$f.log; exit 1; }; done

# The manifest publishes the hash of every scene's pixels; changing it is a reviewed change.
.PHONY: golden golden-update golden-check
$(BUILD)/golden: $(BUILD)/obj/tests/golden/golden.o $(BUILD)/libambiance.a
	@echo "  ld    $@"; $(CC) -o $@ $^ $(LDFLAGS) $(LDLIBS)
golden-check: $(BUILD)/golden
	$(BUILD)/golden check tests/golden/manifest
golden: ## re-render the manifest: {gcc, clang} x {v2, v3, v4} x {1, 2, 5 threads}
	$(MAKE) CC=clang golden-check
	$(MAKE) CC=gcc BUILD=$(BUILD)/gcc golden-check
golden-update: $(BUILD)/golden ## rewrite the manifest from this build (SCENE=name: its rows only)
	$(BUILD)/golden update tests/golden/manifest $(SCENE)

# ---- jobs -----------------------------------------------------------------------------------------------------------
.PHONY: help deps assets demo bench lint format clean
help: ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:[^#]*## /\t/' | sort | expand -t 14

deps: ## install the Debian packages that are missing
	@missing=$$(for p in $(PACKAGES); do \
	    dpkg-query -W -f '$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || echo $$p; done); \
	if [ -n "$$missing" ]; then \
	    echo "installing:" $$missing; \
	    root=; [ "$$(id -u)" = 0 ] || root=sudo; \
	    $$root apt-get update -qq && \
	    $$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $$missing >/dev/null || \
	    { echo "could not install:" $$missing "(as root: apt-get install them)"; exit 1; }; \
	fi

assets: ## fetch the asset pack into build/assets (ASSETS=builtin: nothing; OPTIONAL=1: its optional packages too)
	$(if $(filter builtin,$(ASSETS)),@echo "asset pack: not fetched (ASSETS=builtin)",@AMBIANCE_PACK_OPTIONAL=$(OPTIONAL) scenes/pack/fetch.sh $(BUILD)/assets)

DEMO_SCENES ?= julia elevated hillscape earth jupiter saturn mercury lucy
DEMO_SIZE   ?= 1440x1080
demo: deps ## packages, build, assets, and the gallery in out/ (ASSETS=builtin fetches nothing)
	$(MAKE) all
	$(if $(filter builtin,$(ASSETS)),,$(MAKE) assets)
	@mkdir -p out
	@for s in $(DEMO_SCENES); do \
	    $(BUILD)/ambiance render $$s --size $(DEMO_SIZE) $(if $(filter builtin,$(ASSETS)),--assets builtin) \
	        -o out/$$s.png -o out/$$s.exr || exit $$?; \
	done
	@echo; echo "Look at:"; for s in $(DEMO_SCENES); do echo "  out/$$s.png   (HDR: out/$$s.exr)"; done

bench: ## the table of ratios against llvmpipe and the machine's own peaks
	$(MAKE) $(BUILD)/ambiance-bench
	$(BUILD)/ambiance-bench $(BENCH_ARGS)

# ---- install --------------------------------------------------------------------------------------------------------
# DESTDIR stages, PREFIX stays in the files. Shading functions are headers and library: <ambiance/shade/….h>.
INSTALLED := bin/ambiance include/ambiance lib/libambiance.a lib/libambiance.so lib/libambiance.so.0 \
             lib/libambiance.so.$(VERSION) lib/pkgconfig/ambiance.pc share/man/man1/ambiance.1 \
             share/bash-completion/completions/ambiance
TO = $(DESTDIR)$(PREFIX)
OPENMP_LIB = $(if $(findstring clang,$(CC)),-l:libomp.so.5,-lgomp)
.PHONY: install uninstall test-install
install: all lib ## the program, library, headers, pkg-config file, man page, completion under PREFIX (and DESTDIR)
	@mkdir -p $(TO)/bin $(TO)/include/ambiance/shade $(TO)/lib/pkgconfig $(TO)/share/man/man1 \
	    $(TO)/share/bash-completion/completions
	install -m 755 $(BUILD)/ambiance $(TO)/bin/ambiance
	install -m 644 include/ambiance/*.h include/ambiance/*.inc $(TO)/include/ambiance
	@for h in $(wildcard shade/*.h); do \
	    sed 's|#include "shade/|#include "ambiance/shade/|' $$h > $(TO)/include/ambiance/$$h && chmod 644 $(TO)/include/ambiance/$$h || exit 1; done
	install -m 644 $(BUILD)/libambiance.a $(TO)/lib/libambiance.a
	install -m 755 $(BUILD)/libambiance.so $(TO)/lib/libambiance.so.$(VERSION)
	ln -sf libambiance.so.$(VERSION) $(TO)/lib/libambiance.so.0
	ln -sf libambiance.so.0 $(TO)/lib/libambiance.so
	@sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|; s|@LIBS@|$(strip $(LDLIBS) $(OPENMP_LIB))|' cli/ambiance.pc.in > $(TO)/lib/pkgconfig/ambiance.pc
	@chmod 644 $(TO)/lib/pkgconfig/ambiance.pc
	install -m 644 docs/ambiance.1 $(TO)/share/man/man1/ambiance.1
	install -m 644 cli/completion.bash $(TO)/share/bash-completion/completions/ambiance
	@if [ -d $(BUILD)/assets ]; then mkdir -p $(TO)/share/ambiance && rm -rf $(TO)/share/ambiance/pack && \
	    cp -R $(BUILD)/assets $(TO)/share/ambiance/pack && echo "installed the asset pack"; fi
	@[ -n "$(DESTDIR)" ] || [ "$$(id -u)" != 0 ] || ldconfig
uninstall: ## what install put there
	rm -rf $(addprefix $(TO)/,$(INSTALLED) share/ambiance)
test-install: all lib ## a user's shader against the installed library, for every instruction set
	CC=$(CC) MAKE="$(MAKE)" BUILD=$(BUILD) tests/install/run.sh

FORMAT_FILES = $(shell git ls-files '*.c' '*.h')
format: ## clang-format every file
	clang-format -i $(FORMAT_FILES)
lint: ## clang-format and clang-tidy, both clean
	clang-format --dry-run -Werror $(FORMAT_FILES)
	clang-tidy --quiet $(filter-out %_wide.c,$(filter %.c,$(FORMAT_FILES))) -- $(CPPFLAGS) -std=c17 -fopenmp
	clang-tidy --quiet $(filter %_wide.c,$(FORMAT_FILES)) -- $(CPPFLAGS) -std=c17 -fopenmp -DAMB_LANES=8 $(ISA_8)

clean: ## remove what this build made
	rm -rf $(BUILD)

.SECONDARY:
.DELETE_ON_ERROR:
