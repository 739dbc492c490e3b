// ${ name }$_queue_formal: formal properties of ${ name }$_queue
//
// For formal tools only. All inputs are arbitrary, but a start waits for the pipeline and for room.
// A stub replaces the pipeline: it accepts a point in any clock, delivers the results of the points
// that it has accepted in any later clock, and has arbitrary results. To prove the properties, run in
// a directory with the files of both folders:
//   $ yosys -q ${ name }$_queue_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ name }$_queue_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ name }$_queue_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

module ${ name }$ (
<%- for line in stub_ports %>
    ${ line }$
<%- endfor %>
);
    (* anyseq *) reg delivers;
<%- if accepts %>
    (* anyseq *) reg accepts;
    assign in_ready = accepts;
<%- else %>
    wire accepts = 1'b1;
<%- endif %>
<%- for result in results %>
    (* anyseq *) reg ${ result.range }$any_${ result.name }$;
    assign ${ result.name }$ = any_${ result.name }$;
<%- endfor %>
<%- if side %>
    assign side_out = 0;
<%- endif %>
    // The number of points in the pipeline.
    reg ${ queue.count }$ inside;
    assign out_valid = inside != 0 && delivers;
    wire enters = in_valid && accepts;
    always @(posedge clk) inside <= rst_n ? inside + enters - out_valid : 0;
endmodule

module ${ name }$_queue_formal (
    input wire clk,
    input wire rst_n,
<%- for operand in operands %>
    input wire ${ operand.range }$${ operand.name }$,
    input wire ${ operand.name }$_write,
<%- endfor %>
    input wire start,
    input wire take
);
    wire valid;
    wire busy;
    wire done;
    wire full;
    wire offering;
    wire ${ queue.count }$ waiting;
<%- for result in results %>
    wire ${ result.range }$${ result.name }$;
<%- endfor %>

    ${ name }$_queue dut (
        .clk(clk),
        .rst_n(rst_n),
<%- for operand in operands %>
        .${ operand.name }$(${ operand.name }$),
        .${ operand.name }$_write(${ operand.name }$_write),
<%- endfor %>
        .start(start),
        .valid(valid),
        .busy(busy),
        .done(done),
        .full(full),
        .offering(offering),
        .waiting(waiting),
        .take(take)<% for result in results %>,
        .${ result.name }$(${ result.name }$)<% endfor %>
    );

    // Internal signals of the design that the assertions read.
    (* hierconn *) wire ${ queue.count }$ \dut.pipeline.inside ;
<%- for wire in inside %>
    ${ wire }$
<%- endfor %>

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);
    always @* if (!$initstate && (full || offering)) assume (!start);

    wire takes = take && waiting != 0;
<%- for line in shown %>
${ line }$
<%- endfor %>
    always @* if (!$initstate) begin
        assert (valid == done);
        // A point that was started waits for the pipeline, is in it, or has its result in the queue.
        assert (dut.claimed == 32'd0 + waiting + dut.pipeline.inside + dut.offered);
        assert (dut.claimed <= ${ queue.full }$);
        assert (busy == (dut.offered || dut.pipeline.inside != 0));
        assert (full == (dut.claimed == ${ queue.full }$));
        assert (offering == (dut.offered && !dut.accepted));
        // The results are at the places from head on, and the next one follows them. Without a
        // result that waits, head is the place of the one that was taken last.
        assert (dut.tail == <% if queue.place_bits == 1 %>(dut.head ^ (waiting == 0 || waiting[0]))<% else %>dut.head + (waiting == 0 ? ${ queue.next }$ : waiting[${ queue.place_bits - 1 }$:0])<% endif %>);
    end

    // The solver picks one of the results that arrive, and the properties follow it until it is taken.
    (* anyseq *) reg picks;
    reg followed;
    reg ${ queue.word }$value;
    reg ${ queue.place }$place;
    reg ${ queue.count }$ before;  // results that wait and are older
    always @(posedge clk) begin
        if (!rst_n) begin
            followed <= 0;
        end else if (!followed) begin
            followed <= dut.arrives && picks;
<%- for line in picked %>
${ line }$
<%- endfor %>
            place <= dut.tail;
            before <= waiting - takes;
        end else if (takes) begin
            followed <= before != 0;
            before <= before - 1;
        end
    end
    reg ${ queue.word }$stored;
    always @* begin
        case (place)
<%- for word in words %>
            ${ loop.index0 }$: stored = ${ word }$;
<%- endfor %>
        endcase
    end
    wire ${ queue.place }$expected_place = dut.head + before;
    always @* if (!$initstate && followed) begin
        // The result keeps its value and its place in the order.
        assert (before < waiting);
        assert (place == expected_place);
        assert (stored == value);
        if (before == 0) assert (shown == value);
    end

    always @(posedge clk) if (!$initstate && $past(!$initstate) && $past(rst_n)) begin
        // done is high for one clock, after a result has arrived.
        assert (done == $past(dut.arrives));
        assert (waiting == $past(waiting) + $past(dut.arrives) - $past(takes));
        // A start offers the point until the pipeline accepts it.
        if ($past(start)) assert (dut.offered);
        if ($past(dut.offered && !dut.accepted)) assert (dut.offered);
        // The pipeline gets the operands that are loaded with the start, and they do not change
        // until it has accepted the point.
<%- for operand in operands %>
        assert (dut.held_${ operand.name }$ == ($past(${ operand.name }$_write && start)
                ? $past(${ operand.name }$) : $past(dut.held_${ operand.name }$)));
<%- endfor %>
        // The outputs change only when a result is taken, or arrives and finds an empty queue.
        if ($past(!takes && !(dut.arrives && waiting == 0))) assert (shown == $past(shown));
        if ($past(takes && waiting == 1 && !dut.arrives)) assert (shown == $past(shown));
    end
endmodule

`default_nettype wire
