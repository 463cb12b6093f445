// Runs one stage over streams and writes what it did. The same program on the host and on a core.
//
//   run report=FILE digests=FILE (recipes=FILE | recording=FILE) [seconds=N]
//
// digests: one u32 a call (push or flush), the digest of all output of the stream so far, so that
// the first record that differs between two machines can be named. The counting plugin writes its
// counts in the same order. report: one line a stream.
#include "tests/target/platform.hpp"
#include "tests/target/recording.hpp"
#include "tests/target/stream.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::target;

template <std::size_t N>
class Writer {
  public:
    bool open(const char* path) {
        file_ = platform::open_to_write(path);
        return file_ >= 0;
    }
    void put(const void* from, std::size_t size) {
        const auto* bytes = static_cast<const unsigned char*>(from);
        for (std::size_t i = 0; i < size; ++i) {
            if (used_ == N) drain();
            buffer_[used_++] = bytes[i];
        }
    }
    Writer& text(const char* s) {
        for (; *s != '\0'; ++s) put(s, 1);
        return *this;
    }
    Writer& number(std::uint32_t x) {
        char digits[10];
        std::size_t n = 0;
        do digits[n++] = static_cast<char>('0' + x % 10);
        while ((x /= 10) != 0);
        while (n > 0) put(&digits[--n], 1);
        return *this;
    }
    void drain() {
        if (used_ > 0 && !platform::write(file_, buffer_, used_))
            platform::complain("cannot write\n");
        used_ = 0;
    }

  private:
    int file_{-1};
    std::size_t used_{0};
    unsigned char buffer_[N]{};
};

Writer<256> report;
Writer<1024> digests;
std::uint32_t calls = 0;

// One stream through the stage: begin, offer records, end.
class Run {
  public:
    explicit Run(const char* name) : name_{name}, first_{calls} { subject_start(nullptr); }

    void push(const Record& record) {
        mix(input_, record.sample);
        mix(input_, record.pose);
        subject_prepare(&record);
        platform::call_marked(&subject_push, &record);
        ++pushes_;
        note();
    }
    void finish() {
        constexpr int flushes_max = 20000;  // beyond it the stage never ends: the report shows it
        bool more = true;
        for (int i = 0; more && i < flushes_max; ++i) {
            platform::call_marked(&subject_flush, nullptr);
            more = note();
        }
        report.text("stream ").text(name_).text(" first ").number(first_);
        report.text(" pushes ").number(pushes_).text(" flushes ").number(calls - first_ - pushes_);
        report.text(" outputs ").number(outputs_).text(" input ").number(input_.value());
        report.text(" output ").number(output_.value()).text("\n");
    }

  private:
    bool note() {
        const bool gave = subject_output(&output_);
        outputs_ += gave ? 1 : 0;
        const std::uint32_t value = output_.value();
        digests.put(&value, sizeof value);
        ++calls;
        return gave;
    }

    const char* name_;
    std::uint32_t first_, pushes_{0}, outputs_{0};
    Digest input_, output_;
};

Record record;  // static: a core has little stack
Recipe recipe;

void run_recipe() {
    Run run{recipe.name};
    Generator generator{recipe};
    while (generator.next(record, subject_takes_anything)) run.push(record);
    run.finish();
}

bool run_recipes(const char* path) {
    const int file = platform::open_to_read(path);
    if (file < 0) return false;
    static char line[768], block[256];
    std::size_t used = 0, got;
    while ((got = platform::read(file, block, sizeof block)) > 0) {
        for (std::size_t i = 0; i < got; ++i) {
            if (block[i] != '\n') {
                if (used + 1 < sizeof line) line[used++] = block[i];
                continue;
            }
            line[used] = '\0';
            used = 0;
            if (parse(line, recipe))
                run_recipe();
            else if (line[0] != '\0' && line[0] != '#')
                report.text("unreadable ").text(line).text("\n");
        }
    }
    platform::close(file);
    return true;
}

bool run_recording(const char* path, std::uint32_t seconds) {
    static RecordingReader reader;
    if (!reader.open(path)) return false;
    if (reader.has_samples() == subject_takes_samples) {
        Run run{"recording"};
        std::int64_t end_ns = 0;
        for (bool first = true; reader.next(record); first = false) {
            const std::int64_t t_ns = subject_takes_samples ? record.sample.t_ns : record.pose.t_ns;
            if (first) end_ns = t_ns + std::int64_t{1'000'000'000} * seconds;
            if (seconds > 0 && t_ns >= end_ns) break;
            run.push(record);
        }
        run.finish();
    }
    reader.close();
    return true;
}

const char* value_of(int argc, char** argv, const char* key) {
    for (int i = 1; i < argc; ++i) {
        const char* word = argv[i];
        const char* k = key;
        while (*k != '\0' && *k == *word) ++k, ++word;
        if (*k == '\0' && *word == '=') return word + 1;
    }
    return nullptr;
}

}  // namespace

int main(int argc, char** argv) {
    platform::command_line(argc, argv);
    const char* const report_path = value_of(argc, argv, "report");
    const char* const digests_path = value_of(argc, argv, "digests");
    const char* const recipes = value_of(argc, argv, "recipes");
    const char* const recording = value_of(argc, argv, "recording");
    std::uint32_t seconds = 0;
    for (const char* s = value_of(argc, argv, "seconds"); s != nullptr && *s != '\0'; ++s)
        seconds = seconds * 10 + static_cast<std::uint32_t>(*s - '0');
    if (report_path == nullptr || !report.open(report_path) || digests_path == nullptr ||
        !digests.open(digests_path)) {
        platform::complain("run: report= and digests= must name files that can be written\n");
        return 2;
    }
    const bool fine = recipes != nullptr     ? run_recipes(recipes)
                      : recording != nullptr ? run_recording(recording, seconds)
                                             : false;
    if (!fine) platform::complain("run: recipes= or recording= must name a readable file\n");
    report.text("subject size ").number(subject_size).text(" latency ").number(subject_latency);
    report.text(" stack ").number(static_cast<std::uint32_t>(platform::stack_used()));
    report.text(" text ").text(subject_text).text("\n");
    report.drain();
    digests.drain();
    return fine ? 0 : 2;
}
