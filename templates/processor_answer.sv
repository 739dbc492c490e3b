    // The answer to the instruction `asked` that the core computes in this clock.
    reg [31:0] answer;
    always @* begin
        case (asked[9:4])
<%- for answer in proof.answers %>
            ${ answer.number }$: answer = ${ answer.word }$;
<%- endfor %>
            default: answer = 32'd0;
        endcase
    end
    // Whether there is such an instruction.
<%- for line in proof.known %>
${ line }$
<%- endfor %>
