#include "host_sim/recording/event_file.hpp"

#include <charconv>

#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

template <class T>
bool whole(const std::string& text, T& value) {
    const char* end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    return result.ec == std::errc{} && result.ptr == end;
}

/// @return what is wrong with the line; empty: nothing.
std::string parse_line(const std::string& line, Event& event) {
    const auto fields = split(line, ',');
    if (fields.size() != 3 && fields.size() != 4)
        return std::to_string(fields.size()) + " columns, expected t_ns,channel,value[,gap]";
    if (!whole(fields[0], event.t_ns)) return "'" + fields[0] + "' is not a time in nanoseconds";
    if (!whole(fields[1], event.channel) || !whole(fields[2], event.value))
        return "channel and value are integers from 0 to 65535";
    if (fields.size() == 4 && fields[3] == "1")
        event.flags = flag::gap_before;
    else if (fields.size() == 4 && fields[3] != "0")
        return "gap is 0 or 1";
    return {};
}

}  // namespace

std::string to_events_csv(const std::vector<Event>& events) {
    std::string csv = "t_ns,channel,value,gap\n";
    for (const Event& event : events)
        csv += std::to_string(event.t_ns) + "," + std::to_string(event.channel) + "," +
               std::to_string(event.value) +
               ((event.flags & flag::gap_before) != 0 ? ",1\n" : ",0\n");
    return csv;
}

std::vector<Event> parse_events(std::string_view text, const std::string& name) {
    std::vector<Event> events;
    std::size_t number = 0;
    for (std::size_t start = 0; start < text.size();) {
        const auto end = std::min(text.find('\n', start), text.size());
        std::string line(text.substr(start, end - start));
        start = end + 1;
        ++number;
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty() || line.front() == '#' || line.substr(0, 5) == "t_ns,") continue;
        Event event;
        const std::string wrong = parse_line(line, event);
        if (!wrong.empty()) throw BadData(name + ": line " + std::to_string(number) + ": " + wrong);
        events.push_back(event);
    }
    return events;
}

std::vector<Event> read_events(const std::string& path) {
    return path.empty() ? std::vector<Event>{} : parse_events(read_bytes(path), path);
}

}  // namespace fairlead::sim
