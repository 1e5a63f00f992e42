# The tools and urdfdom for wasm32-wasi; called by tools.sh with ROOT, OUT and OPTIMIZATION.

build := $(OUT)/build
objects := $(build)/objects$(OPTIMIZATION)
urdfdom := $(build)/urdfdom
tools := rbd-model rbd-codegen rbd-eval

target := --target=wasm32-wasi -fwasm-exceptions
includes := -I$(ROOT) -I$(ROOT)/tools -I$(objects) $(addprefix -isystem ,$(ROOT)/web/wasm/libcxx $(urdfdom)/tinyxml \
    $(urdfdom)/console-bridge/include $(urdfdom)/urdfdom/urdf_parser/include $(wildcard $(urdfdom)/urdfdom-headers/*/include))
# urdfdom's messages name its source files: without this build's folder. No function is inlined by force, as in
# tools/meson.build, which says too why contraction is off.
flags := $(target) $(OPTIMIZATION) $(includes) -MMD -ffile-prefix-map=$(urdfdom)/= -Dalways_inline=unused -ffp-contract=off
warnings := -Wall -Wextra -Werror
c := clang-19 -std=c99 $(flags) $(warnings)
cpp := clang++-19 -std=c++17 $(flags) $(warnings)
foreign := clang++-19 -std=c++17 $(flags) -w -DTIXML_USE_STL

# Objects are named after their sources, in their folders; record.cpp and own_sines.cpp are compiled once for each scalar.
mains := rbd_model rbd_codegen rbd_eval
scalars := double float
record := $(scalars:%=$(objects)/record_%.o)
sines := $(scalars:%=$(objects)/own_sines_%.o)
object = $(patsubst $(1)/%,$(objects)/%.o,$(basename $(2)))
# MuJoCo's library, which reads MJCF, is not built: of such a file the commands say so.
ours := $(filter-out $(mains:%=$(objects)/tools/%.o) $(objects)/tools/rbd_mjcf.o \
    $(addprefix $(objects)/tools/codegen/,record.o own_sines.o), \
    $(call object,$(ROOT),$(wildcard $(ROOT)/tools/*.c $(ROOT)/tools/*.cpp $(ROOT)/tools/codegen/*.cpp) \
    $(ROOT)/web/wasm/exceptions.cpp)) $(record) $(sines)
theirs := $(call object,$(urdfdom),$(addprefix $(urdfdom)/, \
    $(addprefix tinyxml/,tinystr.cpp tinyxml.cpp tinyxmlerror.cpp tinyxmlparser.cpp) console-bridge/src/console.cpp \
    $(addprefix urdfdom/urdf_parser/src/,model.cpp link.cpp joint.cpp pose.cpp)))

all: $(tools:%=$(OUT)/%.wasm)

# Between --start-lib and --end-lib the linker takes the objects that are needed. A trap ends what outgrows the stack.
$(OUT)/rbd-%.wasm: $(objects)/tools/rbd_%.o $(ours) $(theirs)
	clang++-19 $(target) -Wl,--strip-all -Wl,-z,stack-size=1048576 -o $@ $< -Wl,--start-lib $(ours) $(theirs) -Wl,--end-lib

$(objects)/%.o: $(ROOT)/%.c
	@mkdir -p $(@D)
	$(c) -c $< -o $@
$(objects)/%.o: $(ROOT)/%.cpp
	@mkdir -p $(@D)
	$(cpp) -c $< -o $@
$(record): $(objects)/record_%.o: $(ROOT)/tools/codegen/record.cpp
	@mkdir -p $(@D)
	$(cpp) -DCONSTANTS=$* -DRECORD=record_$* -DRECORD_SPACE=of_$* -c $< -o $@
$(sines): $(objects)/own_sines_%.o: $(ROOT)/tools/codegen/own_sines.cpp
	@mkdir -p $(@D)
	$(cpp) -DSCALAR=$* -c $< -o $@
$(objects)/sincos_text.h: $(ROOT)/tools/codegen/sincos_text.sed $(addprefix $(ROOT)/src/base/,reduction.h sincos.h)
	@mkdir -p $(@D)
	sed -f $^ >$@
$(objects)/tools/codegen/sines.o: $(objects)/sincos_text.h
$(theirs): $(objects)/%.o: $(urdfdom)/%.cpp
	@mkdir -p $(@D)
	$(foreign) -c $< -o $@

.SECONDARY: # objects stay: the playground links some of them
-include $(patsubst %.o,%.d,$(ours) $(theirs) $(mains:%=$(objects)/tools/%.o))
