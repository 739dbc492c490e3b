// ${ name }$_registers_formal: formal properties of ${ name }$_registers
//
<%- if queue.is_some() %>
// For formal tools only. All inputs are arbitrary. A stub with the handshake of the queue replaces
// the queue and the pipeline in it: the results arrive at any time and are arbitrary. To prove the
// properties, run in a directory with the files of both folders:
<%- else %>
// For formal tools only. All inputs are arbitrary. A stub with the handshake of the core replaces
// the core: busy is high from the clock after start to done, and the results are arbitrary. To
// prove the properties, run in a directory with the files of both folders:
<%- endif %>
//   $ yosys -q ${ name }$_registers_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ name }$_registers_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ name }$_registers_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

<%- if let Some(queue) = queue %>
<% include "queue_stub.sv" %>
<%- else %>
<% include "core_stub.sv" %>
<%- endif %>

module ${ name }$_registers_formal (
    input wire clk,
    input wire rst_n,
    input wire write,
    input wire [${ address_high }$:2] write_at,
    input wire [31:0] write_data,
    input wire [3:0] write_bytes,
    input wire read,
    input wire [${ address_high }$:2] read_at
);
    wire write_answer;
    wire write_error;
    wire read_answer;
    wire read_error;
    wire [31:0] read_data;
    wire irq;

    ${ name }$_registers dut (
        .clk(clk),
        .rst_n(rst_n),
        .write(write),
        .write_at(write_at),
        .write_data(write_data),
        .write_bytes(write_bytes),
        .write_answer(write_answer),
        .write_error(write_error),
        .read(read),
        .read_at(read_at),
        .read_answer(read_answer),
        .read_error(read_error),
        .read_data(read_data),
        .irq(irq)
    );

    // Internal signals of the design that the assertions read.
<%- for wire in inside %>
    ${ wire }$
<%- endfor %>

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    localparam WORDS = ${ word_count }$;
    wire [31:0] write_word = write_at;
    wire [31:0] read_word = read_at;
    wire write_mapped =
            write_word >= ${ control_number }$ && write_word <= ${ last_written_number }$;
    wire is_result =
            read_word >= ${ first_result_number }$ && read_word <= ${ last_result_number }$;
<%- if let Some((first, last)) = table %>
    wire is_table = write_word >= ${ first }$ && write_word <= ${ last }$;
<%- endif %>
<%- if let Some(queue) = queue %>
    wire under_way = dut.start || dut.core.busy;
    wire start_waits = dut.start || dut.core.offering;
    wire no_room = dut.core.full && !dut.take;
    // A result waits beside the one that is being taken.
    wire fresh = dut.core.waiting > dut.take;
    wire result_waits = under_way && !fresh;
    wire ended = dut.core.done;
<%- else %>
    wire start_waits = dut.start || dut.core.run;
    wire result_waits = start_waits;
    wire ended = dut.core.run && dut.core.ends;
<%- endif %>
    wire asks_start = write_mapped
            && (dut.start_on_write && write_word == dut.start_word && write_bytes != 0
                || write_word == ${ control_number }$ && write_bytes[0] && write_data[0]);

    always @* if (!$initstate) begin
        // A request waits only for a computation. There is no answer without a request.
<%- if table.is_none() %>
        if (write && !write_answer) assert (asks_start && start_waits);
<%- else %>
        if (write && !write_answer) begin
            assert (asks_start && start_waits || is_table && dut.table_pending);
        end
        // The core gets the word that was written.
        assert (dut.core.table_write == dut.table_pending);
<%- endif %>
        if (read && !read_answer) assert (is_result && result_waits);
        if (!write) assert (!write_answer);
        if (!read) assert (!read_answer);
        // A result is read only after the computation has ended.
        if (read_answer && is_result) assert (!result_waits);
<%- if queue.is_some() %>
        assert (dut.core.take == dut.take);
<%- endif %>
        // An access is an error exactly if its address is not in the map or, for a write,
        // read-only<% if queue.is_some() %>, or if it would start a point without room for its result<% endif %>.
<%- if queue.is_some() %>
        assert (write_error == (!write_mapped || asks_start && no_room));
<%- else %>
        assert (write_error == !write_mapped);
<%- endif %>
        assert (read_error == (read_word >= WORDS));
        assert (dut.core.rst_n == rst_n);
        assert (irq == (dut.interrupt_enable && dut.interrupt_pending));
        // The core gets the operands that were written.
<%- for operand in operands %>
        assert (dut.core.${ operand.name }$ == dut.operand_${ operand.name }$);
<%- endfor %>
    end

    // Whether a register was written in the clock before, and the address of that write.
    reg took;
    reg [31:0] took_word;
    always @(posedge clk) begin
        took <= write_answer && !write_error;
        took_word <= write_word;
    end
    wire took_control = took && took_word == ${ control_number }$;
    wire took_enable = took && took_word == ${ control_number + 1 }$;
    wire took_pending = took && took_word == ${ control_number + 2 }$;
    always @(posedge clk) if (!$initstate && $past(!$initstate)) begin
        // In the clock after its request, a read shows all bits of its register: an operand as it
        // was written, and 0 for a result before the first computation has ended.
        if ($past(read_error)) assert (read_data == 0);
<%- if queue.is_some() %>
        // A result that waits stays until it is taken.
        if ($past(rst_n && read_answer && is_result && fresh)) assert (dut.core.waiting != 0);
<%- else %>
        if ($past(read_answer && is_result)) assert (!dut.core.run);
<%- endif %>
<%- for (number, value) in reads %>
        if ($past(read_word) == ${ number }$) begin
<%- for line in value %>
${ line }$
<%- endfor %>
        end
<%- endfor %>
    end
    always @(posedge clk) if (!$initstate && $past(!$initstate) && $past(rst_n)) begin
        // Each write that asks for a start starts one computation, and nothing else starts one.
        assert (dut.start == $past(write_answer && asks_start<% if queue.is_some() %> && !no_room<% endif %>));
        // A write changes the enabled bytes of the addressed register, and nothing else.
        assert (dut.start_on_write == (took_control && $past(write_bytes[0])
                ? $past(write_data[1]) : $past(dut.start_on_write)));
        assert (dut.start_word == (took_control && $past(write_bytes[1])
                ? $past(write_data[${ word_high + 8 }$:8]) : $past(dut.start_word)));
        assert (dut.interrupt_enable == (took_enable && $past(write_bytes[0])
                ? $past(write_data[0]) : $past(dut.interrupt_enable)));
        assert (dut.interrupt_pending == ($past(ended)
                || $past(dut.interrupt_pending)
                && !(took_pending && $past(write_bytes[0] && write_data[0]))));
<%- if let Some((_, last)) = table %>
        // A write to the address of the table asks for a word to be loaded, until the core is ready.
        assert (dut.table_pending == (took && took_word == ${ last }$ && $past(write_bytes != 0)
                || $past(dut.table_pending && !dut.core.table_ready)));
        // A word does not change while it waits.
        if ($past(dut.table_pending && !dut.core.table_ready)) begin
<%- for operand in operands %>
<%- if operand.is_of_table %>
            assert ($stable(dut.operand_${ operand.name }$));
<%- endif %>
<%- endfor %>
        end
<%- endif %>
<%- if queue.is_some() %>
        assert (dut.finished == $past(ended || dut.finished));
        // A read of the last result register takes one result, and nothing else takes one.
        assert (dut.take == $past(read_answer && fresh && read_word == ${ last_result_number }$));
<%- else %>
        assert (dut.finished == ($past(ended) || $past(dut.finished) && !$past(dut.start)));
<%- endif %>
<%- for operand in operands %>
<%- for lane in operand.lanes %>
        if (took && took_word == ${ lane.number }$ && $past(write_bytes[${ lane.byte }$])) begin
            assert (dut.operand_${ operand.name }$${ lane.bits }$ == $past(write_data${ lane.data }$));
        end else begin
            assert ($stable(dut.operand_${ operand.name }$${ lane.bits }$));
        end
<%- endfor %>
<%- endfor %>
    end
endmodule

`default_nettype wire
