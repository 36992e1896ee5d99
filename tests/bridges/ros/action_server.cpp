// A robot with the action /move_base, by actionlib's SimpleActionServer in C++: see action_node.py.

#include <algorithm>
#include <iostream>
#include <string>

#include <actionlib/server/simple_action_server.h>
#include <move_base_msgs/MoveBaseAction.h>
#include <ros/ros.h>

typedef actionlib::SimpleActionServer<move_base_msgs::MoveBaseAction> Server;

void begin(Server* server) {
  std::cout << "drives " << server->acceptNewGoal()->target_pose.pose.position.x << std::endl;
}

void cancel(Server* server) {
  if (server->isNewGoalAvailable()) return;
  std::cout << "stands" << std::endl;
  server->setPreempted(Server::Result(), "as you wish");
}

int main(int argc, char** argv) {
  ros::init(argc, argv, "robot", ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
  ros::NodeHandle node;
  Server server(node, "/move_base", false);
  server.registerGoalCallback(boost::bind(&begin, &server));
  server.registerPreemptCallback(boost::bind(&cancel, &server));
  server.start();
  ros::AsyncSpinner spinner(1);
  spinner.start();
  std::cout << "ready" << std::endl;
  std::string line;
  while (std::getline(std::cin, line)) {
    const std::string word = line.substr(0, line.find(' '));
    const std::string rest = line.substr(std::min(line.size(), word.size() + 1));
    if (word == "feedback") {
      move_base_msgs::MoveBaseFeedback feedback;
      feedback.base_position.pose.position.x = std::stod(rest);
      server.publishFeedback(feedback);
    } else {
      std::cout << "stands" << std::endl;
      if (word == "succeed") server.setSucceeded(Server::Result(), "there");
      if (word == "abort") server.setAborted(Server::Result(), rest);
    }
  }
}
