<%- for group in groups %>

    always @(posedge clk) begin
<%- for line in group %>
${ line }$
<%- endfor %>
    end
<%- endfor %>