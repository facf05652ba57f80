# ambiance: GNU make, no generator. `make help` lists the targets.
#
# A file named *_wide.c is compiled once per instruction set; core/, shade/ and tests/ ones also at one lane.
# Everything else is compiled once. CC=gcc or CC=clang; BUILD=dir keeps builds apart.

ifeq ($(origin CC),default)
CC := $(if $(shell command -v clang 2>/dev/null),clang,gcc)
endif
BUILD   ?= build
PREFIX  ?= /usr/local
ASSETS  ?= pack
CCACHE  ?= $(shell command -v ccache 2>/dev/null)
OPT     ?= -O2
SANITIZE ?=
VERSION := 0.1.0

# One list for a fresh Debian 12: what `make demo` and `make test` install when it is missing.
PACKAGES := clang gcc libomp-dev libclang-rt-14-dev pkg-config libembree-dev libopenexr-dev libassimp-dev libstb-dev \
            libpng-dev libmd-dev zlib1g-dev libjansson-dev libcmocka-dev libegl-dev libgles-dev libegl-mesa0 libgl1-mesa-dri
export PACKAGES

LIBS_PKG := OpenEXR assimp stb libpng libmd
comma := ,

# ---- flags ----------------------------------------------------------------------------------------------------------
# The promise "same bits everywhere" rests on -ffp-contract=off and on nothing from fast-math (docs/determinism.md).
WARN    := -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wstrict-prototypes -Wmissing-prototypes \
           -Wno-bool-operation -Wno-psabi -Wno-unknown-warning-option
EXACT   := -ffp-contract=off -fno-math-errno -fno-trapping-math
CPPFLAGS += -Iinclude -I. -D_GNU_SOURCE -DAMB_VERSION='"$(VERSION)"' -isystem /usr/include/OpenEXR \
            -isystem /usr/include/Imath -isystem /usr/include/stb
CFLAGS  += -std=c17 $(OPT) -g1 -fPIC -fopenmp -fvisibility=default $(EXACT) $(WARN) $(SANITIZE)
LDFLAGS += -fopenmp $(SANITIZE)
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
.PHONY: check
check: $(TESTS) $(BUILD)/ambiance ## unit and property tests of this build (under a minute)
	@fail=0; for t in $(TESTS); do echo "== $$t"; AMBIANCE=$(BUILD)/ambiance $$t || fail=1; done; exit $$fail

.PHONY: clean
clean: ## remove what this build made
	rm -rf $(BUILD)

.SECONDARY:
.DELETE_ON_ERROR:
