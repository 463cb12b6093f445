/* A plugin for QEMU (TCG plugin API, version 1): counts the guest's instructions between the
   two marker instructions of port/cortex_m/mark.hpp. Debian ships no header for it, so the few
   functions used are declared here.

   Arguments: out=FILE    one little-endian u32 a marked call, in the order of execution
              heads=FILE  in: lines "address size part", the first of which tells the calls that
   matter; replaced at exit by "address count", the most often that the instruction there
   (hexadecimal) ran in one such call, and "part number count", the most instructions of a part (1
   to 8; 0 is none) in one such call, where every run of an address is worth its size A translation
   block adds its length when it is entered; a marker corrects by its place in the block. Blocks
   with markers therefore count exactly, as tests/target/calibrate.cpp checks. */
#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum qemu_plugin_cb_flags { QEMU_PLUGIN_CB_NO_REGS };
struct qemu_info {
    const char* target_name; /* more follows */
};
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 };

extern void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t,
                                                  void (*)(qemu_plugin_id_t,
                                                           struct qemu_plugin_tb*));
extern void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb*, enum qemu_plugin_op,
                                                     void*, uint64_t);
extern void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn*,
                                                   void (*)(unsigned, void*),
                                                   enum qemu_plugin_cb_flags, void*);
extern void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, void (*)(qemu_plugin_id_t, void*),
                                           void*);
extern size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb*);
extern struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb*, size_t);
extern void qemu_plugin_register_vcpu_insn_exec_inline(struct qemu_plugin_insn*,
                                                       enum qemu_plugin_op, void*, uint64_t);
extern uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn*);
extern size_t qemu_plugin_insn_size(const struct qemu_plugin_insn*);
extern const void* qemu_plugin_insn_data(const struct qemu_plugin_insn*);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

static uint64_t entered; /* instructions of all blocks entered so far */
static uint64_t begun;   /* instructions executed up to and with the last begin marker */
static bool open_call, on_arm;
static FILE* out;

enum { HEADS_MAX = 16384, PARTS_MAX = 8 };
static struct head {
    uint64_t address, now, most;
    unsigned size, part;
} heads[HEADS_MAX];
static size_t heads_size;
static uint64_t parts[PARTS_MAX + 1];
static const char* heads_path;

/* behind = instructions of the marker's block after the marker */
static void on_begin(unsigned cpu, void* behind) {
    (void)cpu;
    begun = entered - (uintptr_t)behind;
    for (size_t i = 0; i < heads_size; ++i) heads[i].now = 0;
    open_call = true;
}

static void on_end(unsigned cpu, void* behind) {
    (void)cpu;
    if (!open_call) return;
    open_call = false;
    const uint64_t between = entered - (uintptr_t)behind - 1 - begun;
    const uint32_t count = between > UINT32_MAX ? UINT32_MAX : (uint32_t)between;
    fwrite(&count, sizeof count, 1, out);
    uint64_t sums[PARTS_MAX + 1] = {0};
    for (size_t i = 0; heads[0].now > 0 && i < heads_size; ++i) {
        if (heads[i].now > heads[i].most) heads[i].most = heads[i].now;
        sums[heads[i].part] += heads[i].now * heads[i].size;
    }
    for (size_t i = 1; i <= PARTS_MAX; ++i) {
        if (sums[i] > parts[i]) parts[i] = sums[i];
    }
}

enum marker { NO_MARKER, BEGIN, END };

/* Near the end of a page QEMU reports a Thumb instruction together with its successor, so its size
   says nothing; no 32-bit Thumb instruction begins with these halves. */
static enum marker marker_of(const struct qemu_plugin_insn* insn) {
    uint32_t word = 0;
    if (on_arm) {
        memcpy(&word, qemu_plugin_insn_data(insn), 2);
        return word == 0x46d2 ? BEGIN : word == 0x46db ? END : NO_MARKER;
    }
    if (qemu_plugin_insn_size(insn) < 4) return NO_MARKER;
    memcpy(&word, qemu_plugin_insn_data(insn), 4);
    return word == 0x00102013 ? BEGIN : word == 0x00202013 ? END : NO_MARKER;
}

static struct head* head_at(uint64_t address) {
    for (size_t i = 0; i < heads_size; ++i) {
        if (heads[i].address == address) return &heads[i];
    }
    return NULL;
}

static bool read_heads(const char* path) {
    FILE* file = fopen(path, "r");
    if (file == NULL) return false;
    heads_path = path;
    for (struct head* h = heads; heads_size < HEADS_MAX; ++h, ++heads_size) {
        if (fscanf(file, "%" SCNx64 " %u %u", &h->address, &h->size, &h->part) != 3) break;
        if (h->part > PARTS_MAX) return false;
    }
    fclose(file);
    return heads_size > 0 && heads_size < HEADS_MAX;
}

static void write_heads(void) {
    FILE* file = heads_path == NULL ? NULL : fopen(heads_path, "w");
    if (file == NULL) return;
    for (size_t i = 0; i < heads_size; ++i)
        fprintf(file, "%" PRIx64 " %" PRIu64 "\n", heads[i].address, heads[i].most);
    for (size_t i = 1; i <= PARTS_MAX; ++i) fprintf(file, "part %zu %" PRIu64 "\n", i, parts[i]);
    fclose(file);
}

static void on_translate(qemu_plugin_id_t id, struct qemu_plugin_tb* tb) {
    (void)id;
    const size_t n = qemu_plugin_tb_n_insns(tb);
    qemu_plugin_register_vcpu_tb_exec_inline(tb, QEMU_PLUGIN_INLINE_ADD_U64, &entered, n);
    for (size_t i = 0; i < n; ++i) {
        struct qemu_plugin_insn* insn = qemu_plugin_tb_get_insn(tb, i);
        struct head* head = head_at(qemu_plugin_insn_vaddr(insn));
        if (head != NULL) {
            qemu_plugin_register_vcpu_insn_exec_inline(insn, QEMU_PLUGIN_INLINE_ADD_U64, &head->now,
                                                       1);
        }
        const enum marker marker = marker_of(insn);
        if (marker == NO_MARKER) continue;
        qemu_plugin_register_vcpu_insn_exec_cb(insn, marker == BEGIN ? on_begin : on_end,
                                               QEMU_PLUGIN_CB_NO_REGS, (void*)(n - 1 - i));
    }
}

static void on_exit(qemu_plugin_id_t id, void* unused) {
    (void)id;
    (void)unused;
    fclose(out);
    write_heads();
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id,
                                                               const struct qemu_info* info,
                                                               int argc, char** argv) {
    on_arm = strncmp(info->target_name, "arm", 3) == 0;
    for (int i = 0; i < argc; ++i) {
        if (strncmp(argv[i], "out=", 4) == 0) out = fopen(argv[i] + 4, "wb");
        if (strncmp(argv[i], "heads=", 6) == 0 && !read_heads(argv[i] + 6)) {
            fprintf(stderr, "count: %s cannot be used\n", argv[i]);
            return 1;
        }
    }
    if (out == NULL) {
        fprintf(stderr, "count: out=FILE is missing or cannot be written\n");
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translate);
    qemu_plugin_register_atexit_cb(id, on_exit, NULL);
    return 0;
}
