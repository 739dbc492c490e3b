// ${ name }$_single_formal: formal properties of ${ name }$_single
//
// For formal tools only. All inputs are arbitrary. A stub replaces the pipeline: it accepts a point
// in any clock, delivers it in any later clock, and has arbitrary results. To prove the properties,
// run in a directory with the files of both folders:
//   $ yosys -q ${ name }$_single_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ name }$_single_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ name }$_single_formal.smt2
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
    // Whether a point is in the pipeline. The module never has two.
    reg inside;
    assign out_valid = inside & delivers;
    wire enters = in_valid & accepts;
    always @(posedge clk) inside <= rst_n & (inside ? ~out_valid : enters);
    always @* if (!$initstate && inside) assert (!in_valid);
endmodule

module ${ name }$_single_formal (
    input wire clk,
    input wire rst_n,
<%- for operand in operands %>
    input wire ${ operand.range }$${ operand.name }$,
    input wire ${ operand.name }$_write,
<%- endfor %>
    input wire start
);
    wire valid;
    wire busy;
    wire done;
<%- for result in results %>
    wire ${ result.range }$${ result.name }$;
<%- endfor %>

    ${ name }$_single dut (
        .clk(clk),
        .rst_n(rst_n),
<%- for operand in operands %>
        .${ operand.name }$(${ operand.name }$),
        .${ operand.name }$_write(${ operand.name }$_write),
<%- endfor %>
        .start(start),
        .valid(valid),
        .busy(busy),
        .done(done)<% for result in results %>,
        .${ result.name }$(${ result.name }$)<% endfor %>
    );

    // Internal signals of the design that the assertions read.
    (* hierconn *) wire \dut.pipeline.inside ;
<%- for wire in inside %>
    ${ wire }$
<%- endfor %>

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    always @* if (!$initstate) begin
        assert (valid == done);
        // While a computation is under way, its point waits, is in the pipeline, or has arrived.
        assert (busy == (dut.offered || dut.pipeline.inside || done));
        assert (!(dut.offered && done) && !(dut.pipeline.inside && done));
    end

    always @(posedge clk) if (!$initstate && $past(!$initstate) && $past(rst_n)) begin
        // busy is high from the clock after a start to done.
        assert (busy == ($past(busy) ? !$past(done) : $past(start)));
        // done is high for one clock, after the point has arrived.
        assert (done == $past(dut.arrives));
        // A start offers the point until the pipeline accepts it.
        if ($past(start && !busy)) assert (dut.offered);
        if ($past(dut.offered) && !$past(dut.pipeline.inside)) begin
            assert (dut.offered || dut.pipeline.inside);
        end
        // The pipeline gets the operands that were loaded before the start or with it.
<%- for operand in operands %>
        assert (dut.held_${ operand.name }$ == ($past(${ operand.name }$_write && !busy)
                ? $past(${ operand.name }$) : $past(dut.held_${ operand.name }$)));
<%- endfor %>
        // The results are what the pipeline delivers, and stay until the next computation ends.
<%- for result in results %>
        assert (${ result.name }$ == ($past(dut.arrives)
                ? $past(dut.new_${ result.name }$) : $past(${ result.name }$)));
<%- endfor %>
    end
endmodule

`default_nettype wire
